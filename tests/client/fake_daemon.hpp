#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "protocol/codec.hpp"
#include "protocol/endpoint_link.hpp"
#include "protocol/visible_set.hpp"

namespace sightline::testing {

/// A daemon's end in the test's own thread: receives one message at a time and answers as the test says.
class FakeDaemon {
 public:
  explicit FakeDaemon(const std::string& endpoint = "tcp://127.0.0.1:*") : link_(endpoint) {}

  [[nodiscard]] std::string endpoint() const { return link_.bound_endpoint(); }

  /// The next message of type T; others are left out (kept in `heard`).
  template <typename T>
  std::optional<T> next(std::chrono::milliseconds timeout = std::chrono::milliseconds(0)) {
    while (auto incoming = link_.receive(timeout)) {
      auto decoded = decode(incoming->frame);
      auto* message = std::get_if<Message>(&decoded);
      if (message == nullptr) continue;
      peer = incoming->peer;
      heard.push_back(*message);
      if (auto* wanted = std::get_if<T>(message)) return std::move(*wanted);
    }
    return {};
  }

  void send(const Message& message) { link_.send(peer, encode(message)); }
  void send_raw(const Bytes& frame) { link_.send(peer, frame); }

  PeerId peer;  ///< who spoke last
  std::vector<Message> heard;

 private:
  ServerLink link_;
};

}  // namespace sightline::testing
