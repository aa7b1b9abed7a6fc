#pragma once

#include <optional>
#include <stdexcept>
#include <utility>

#include "control_view/session.hpp"
#include "main_view/app/virtual_daemon.hpp"
#include "main_view/client/culling_core.hpp"
#include "main_view/client/session_sets.hpp"

namespace sightline::testing {

/// The daemon's session and the client's sets of it, joined without a socket: sets are encoded and decoded
/// between them as on the wire.
class InProcessSession {
 public:
  InProcessSession(std::uint64_t id, ServedScenePtr scene, const PipelineOptions& pipeline)
      : session_(
            id, PeerId{}, "virtual client", std::move(scene), pipeline, [] { return 0.0; }, 0.0) {}

  Answer ask(const ViewRequest& issued) {
    ViewRequest request = issued;
    request.session_id = session_.id();
    request.acked_set_seq = sets_.acked_seq();
    session_.accept(request, 0.0);
    VisibleSetFrame frame = session_.answer(0.0);
    std::optional<VisibleSet> set = sets_.decode(frame, session_.scene().identity.object_count);
    if (!set) throw std::logic_error("the daemon's answer does not decode");
    Answer answer;
    answer.request = issued;
    answer.set = std::move(*set);
    answer.frame = std::move(frame);
    return answer;
  }

 private:
  Session session_;
  SessionSets sets_;
};

/// Files what has arrived by now.
inline void take_deliveries(VirtualDaemon& daemon, CullingCore& core, double now_s) {
  for (const VirtualDaemon::Delivery& delivery : daemon.deliver(now_s)) {
    core.accept(delivery.answer.request, delivery.issued_s, delivery.answer.set, delivery.received_s);
  }
}

}  // namespace sightline::testing
