#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "protocol/codec.hpp"
#include "protocol/curve_keys.hpp"
#include "protocol/frame.hpp"

namespace sightline {

struct LinkOptions {
  CurveKeys curve;
  /// A peer that sends a larger frame loses its connection, and the frame is never stored.
  std::size_t max_frame_bytes = 64u << 20;
  /// Frames that wait for one peer, and frames of one peer that wait for us. A full queue refuses the newest.
  int send_queue_length = 16;
  int receive_queue_length = 16;
};

/// The client's end: one DEALER socket. ZeroMQ reconnects by itself; this only moves frames.
/// Not thread-safe; no call blocks longer than its timeout. Destruction gives frames on their way 0.1 s to
/// leave.
class ClientLink {
 public:
  /// Returns at once, whether or not anybody listens there. Throws InputError for an endpoint that is no
  /// tcp:// or ipc:// address and for keys that are none.
  ClientLink(const std::string& endpoint, const LinkOptions& options = {});
  ~ClientLink();
  ClientLink(ClientLink&&) noexcept;
  ClientLink& operator=(ClientLink&&) noexcept;

  /// Queues a frame; false when the queue is full (the peer is gone or slow): drop it, newest wins.
  /// What was queued for a peer that went away is delivered to the next one that listens there.
  bool send(const Bytes& frame);
  /// The same without a copy: for large frames. They are held until they have left.
  bool send(const Frame& frame);
  /// Next frame within `timeout`, or empty. Zero polls. Multi-part messages are dropped.
  [[nodiscard]] std::optional<Bytes> receive(std::chrono::milliseconds timeout);
  /// Drops the connection and everything queued, then connects anew to the same endpoint.
  void reconnect();
  /// Bytes moved since construction, payload only.
  [[nodiscard]] std::uint64_t bytes_sent() const noexcept;
  [[nodiscard]] std::uint64_t bytes_received() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Routing id of one connection. A client that reconnects has another.
using PeerId = std::string;

/// The daemon's end: one ROUTER socket. Not thread-safe. Destruction gives frames on their way 0.1 s to
/// leave.
class ServerLink {
 public:
  /// `endpoint` may hold a wildcard port (tcp://127.0.0.1:*). Throws InputError for a bad address and
  /// MachineError when it is in use or cannot be bound.
  ServerLink(const std::string& endpoint, const LinkOptions& options = {});
  ~ServerLink();
  ServerLink(ServerLink&&) noexcept;
  ServerLink& operator=(ServerLink&&) noexcept;

  /// The address that clients connect to, wildcard port resolved.
  [[nodiscard]] std::string bound_endpoint() const;

  struct Incoming {
    PeerId peer;
    Frame frame;
  };
  /// Next frame within `timeout`, or empty. Multi-part messages that are not peer + frame are dropped.
  [[nodiscard]] std::optional<Incoming> receive(std::chrono::milliseconds timeout);
  /// Never blocks; false when the peer is unknown or its queue is full.
  bool send(const PeerId& peer, const Bytes& frame);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
