#include "control_view/ping.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <random>

#include "control_view/clock.hpp"
#include "protocol/codec.hpp"
#include "protocol/endpoint_link.hpp"

namespace sightline {

ExitCode ping(const PingOptions& options) {
  LinkOptions link_options;
  if (!options.keys.empty()) link_options.curve = read_curve_keys(options.keys);
  ClientLink link(options.endpoint, link_options);

  const Clock clock = steady_clock();
  const double began_s = clock();
  const std::uint64_t nonce = std::random_device{}();
  link.send(encode(Ping{nonce, began_s}));
  for (double left_s = options.timeout_s; left_s > 0.0; left_s = options.timeout_s - (clock() - began_s)) {
    const auto frame =
        link.receive(std::chrono::milliseconds{std::max<long>(1, static_cast<long>(left_s * 1e3))});
    if (!frame) continue;
    const auto decoded = decode(*frame);
    const auto* message = std::get_if<Message>(&decoded);
    const auto* pong = message == nullptr ? nullptr : std::get_if<Pong>(message);
    if (pong == nullptr || pong->nonce != nonce) continue;
    std::printf("control_view: %s answered in %.1f ms\n", options.endpoint.c_str(),
                (clock() - began_s) * 1e3);
    return ExitCode::done;
  }
  std::fprintf(stderr, "control_view: no daemon answered at %s within %g s\n", options.endpoint.c_str(),
               options.timeout_s);
  return ExitCode::fell_short;
}

}  // namespace sightline
