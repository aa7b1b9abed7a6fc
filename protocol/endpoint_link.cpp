#include "protocol/endpoint_link.hpp"

#include <algorithm>
#include <utility>

#include <zmq.hpp>

#include "common/error.hpp"
#include "protocol/endpoint.hpp"

namespace sightline {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

// docs/protocol.md states these under "Timings".
constexpr int k_reconnect_interval_ms = 50;
constexpr int k_max_reconnect_interval_ms = 500;
constexpr int k_handshake_timeout_ms = 5000;
constexpr int k_keepalive_idle_s = 10;
constexpr int k_keepalive_interval_s = 5;
constexpr int k_keepalive_probes = 3;

/// How long a closing link may wait for its last frames (a Goodbye, a Refusal because we shut down) to leave.
constexpr int k_farewell_ms = 100;

/// Malformed messages that one call of receive throws away before it lets the caller go on.
constexpr int k_max_dropped_in_a_row = 64;

Bytes bytes_of(const zmq::message_t& message) {
  const auto* begin = static_cast<const std::byte*>(message.data());
  return Bytes(begin, begin + message.size());
}

/// The message's own memory as a frame. Aligned to 8 bytes where the message is a large one.
Frame frame_of(zmq::message_t&& message) {
  // A short message lies in the message itself: it has to have its place before it is looked at.
  auto owner = std::make_shared<zmq::message_t>(std::move(message));
  const std::span<const std::byte> bytes(static_cast<const std::byte*>(owner->data()), owner->size());
  return Frame(std::move(owner), bytes);
}

/// The frame's memory as a message, which holds the frame until ZeroMQ lets go of it.
zmq::message_t message_of(const Frame& frame) {
  auto held = std::make_unique<Frame>(frame);
  // ZeroMQ takes data to change, and changes none that it sends.
  zmq::message_t message(
      const_cast<std::byte*>(frame.data()), frame.size(),
      [](void*, void* hint) { delete static_cast<Frame*>(hint); }, held.get());
  (void)held.release();
  return message;
}

std::string name_of(const Endpoint& endpoint) {
  return "endpoint '" + endpoint.text + "'";
}

template <typename Option>
void set_key(zmq::socket_t& socket, Option option, const std::string& key, const char* name) {
  try {
    socket.set(option, key);
  } catch (const zmq::error_t&) {
    throw InputError(std::string(name) + ": not a CURVE key of 40 Z85 characters");
  }
}

void set_common_options(zmq::socket_t& socket, const Endpoint& endpoint, const LinkOptions& options) {
  socket.set(zmq::sockopt::linger, k_farewell_ms);
  socket.set(zmq::sockopt::maxmsgsize, static_cast<std::int64_t>(options.max_frame_bytes));
  // Zero would mean "no limit" to ZeroMQ.
  socket.set(zmq::sockopt::sndhwm, std::max(1, options.send_queue_length));
  socket.set(zmq::sockopt::rcvhwm, std::max(1, options.receive_queue_length));
  socket.set(zmq::sockopt::ipv6, endpoint.needs_ipv6() ? 1 : 0);
  socket.set(zmq::sockopt::handshake_ivl, k_handshake_timeout_ms);
  // Finds out about a peer whose machine vanished. The protocol's own Ping says whether it still serves.
  // Not ZeroMQ's heartbeats: libzmq 4.3.4 writes them even to a connection that broke while its receive queue
  // was full, and then aborts the process (assertion !_io_error), so that an ordinary client that dies could
  // end the daemon.
  socket.set(zmq::sockopt::heartbeat_ivl, 0);
  socket.set(zmq::sockopt::tcp_keepalive, 1);
  socket.set(zmq::sockopt::tcp_keepalive_idle, k_keepalive_idle_s);
  socket.set(zmq::sockopt::tcp_keepalive_intvl, k_keepalive_interval_s);
  socket.set(zmq::sockopt::tcp_keepalive_cnt, k_keepalive_probes);
}

/// Calls again while a signal interrupts; ZeroMQ's own calls that do not wait are short.
template <typename Call>
auto retry_interrupted(Call call) {
  for (;;) {
    try {
      return call();
    } catch (const zmq::error_t& error) {
      if (error.num() != EINTR) throw;
    }
  }
}

/// Never waits; false when the queue is full or, for a ROUTER, the peer unknown.
template <typename Part>
bool send_part(zmq::socket_t& socket, Part&& part, zmq::send_flags flags = zmq::send_flags::none) {
  try {
    return retry_interrupted(
        [&] { return socket.send(part, flags | zmq::send_flags::dontwait).has_value(); });
  } catch (const zmq::error_t& error) {
    if (error.num() == EHOSTUNREACH) return false;
    throw MachineError(std::string("zmq_send: ") + error.what());
  }
}

/// Waits for input until `deadline`; false when it passed or a signal came.
bool wait_for_input(zmq::socket_t& socket, Clock::time_point deadline) {
  const auto left = std::chrono::ceil<milliseconds>(deadline - Clock::now());
  zmq::pollitem_t item{socket.handle(), 0, ZMQ_POLLIN, 0};
  try {
    return zmq::poll(&item, 1, std::max(left, milliseconds{0})) > 0;
  } catch (const zmq::error_t& error) {
    if (error.num() == EINTR) return false;
    throw MachineError(std::string("zmq_poll: ") + error.what());
  }
}

/// One whole message if there is one; parts beyond the last of `parts` are read and counted, not kept.
/// Gives the number of parts, 0 for no message.
template <std::size_t k_part_count>
std::size_t receive_parts(zmq::socket_t& socket, zmq::message_t (&parts)[k_part_count]) {
  std::size_t count = 0;
  for (bool more = true; more; ++count) {
    zmq::message_t surplus;
    zmq::message_t& part = count < k_part_count ? parts[count] : surplus;
    // The parts of a message arrive together: only the first can be missing.
    if (!retry_interrupted([&] { return socket.recv(part, zmq::recv_flags::dontwait); })) return 0;
    more = part.more();
  }
  return count;
}

/// The next message of exactly `k_part_count` parts, waiting until `timeout` has passed.
template <std::size_t k_part_count>
bool receive_exactly(zmq::socket_t& socket, zmq::message_t (&parts)[k_part_count], milliseconds timeout) {
  const Clock::time_point deadline = Clock::now() + timeout;
  for (int dropped = 0; dropped < k_max_dropped_in_a_row;) {
    const std::size_t count = receive_parts(socket, parts);
    if (count == k_part_count) return true;
    if (count > 0) {
      ++dropped;
    } else if (timeout <= milliseconds{0} || !wait_for_input(socket, deadline)) {
      return false;
    }
  }
  return false;
}

}  // namespace

struct ClientLink::Impl {
  Impl(Endpoint checked_endpoint, LinkOptions link_options)
      : endpoint(std::move(checked_endpoint)), options(std::move(link_options)) {
    if (options.curve.enabled() && options.curve.server_public_key.empty()) {
      throw InputError("server_public_key is missing: a client needs it to encrypt");
    }
    connect();
  }

  void connect() {
    zmq::socket_t fresh(context, zmq::socket_type::dealer);
    set_common_options(fresh, endpoint, options);
    fresh.set(zmq::sockopt::reconnect_ivl, k_reconnect_interval_ms);
    fresh.set(zmq::sockopt::reconnect_ivl_max, k_max_reconnect_interval_ms);
    if (options.curve.enabled()) {
      set_key(fresh, zmq::sockopt::curve_serverkey, options.curve.server_public_key, "server_public_key");
      set_key(fresh, zmq::sockopt::curve_publickey, options.curve.public_key, "public_key");
      set_key(fresh, zmq::sockopt::curve_secretkey, options.curve.secret_key, "secret_key");
    }
    try {
      fresh.connect(endpoint.text);
    } catch (const zmq::error_t& error) {
      throw InputError(name_of(endpoint) + " cannot be connected to: " + error.what());
    }
    socket = std::move(fresh);
  }

  Endpoint endpoint;
  LinkOptions options;
  zmq::context_t context{1};
  zmq::socket_t socket;
  std::uint64_t bytes_sent = 0;
  std::uint64_t bytes_received = 0;
};

ClientLink::ClientLink(const std::string& endpoint, const LinkOptions& options)
    : impl_(std::make_unique<Impl>(parse_endpoint(endpoint, LinkEnd::client), options)) {}
ClientLink::~ClientLink() = default;
ClientLink::ClientLink(ClientLink&&) noexcept = default;
ClientLink& ClientLink::operator=(ClientLink&&) noexcept = default;

bool ClientLink::send(const Bytes& frame) {
  if (!send_part(impl_->socket, zmq::buffer(frame))) return false;
  impl_->bytes_sent += frame.size();
  return true;
}

bool ClientLink::send(const Frame& frame) {
  zmq::message_t message = message_of(frame);
  if (!send_part(impl_->socket, message)) return false;
  impl_->bytes_sent += frame.size();
  return true;
}

std::optional<Bytes> ClientLink::receive(milliseconds timeout) {
  zmq::message_t parts[1];
  if (!receive_exactly(impl_->socket, parts, timeout)) return {};
  impl_->bytes_received += parts[0].size();
  return bytes_of(parts[0]);
}

void ClientLink::reconnect() {
  impl_->socket.set(zmq::sockopt::linger, 0);
  impl_->socket.close();
  impl_->connect();
}

std::uint64_t ClientLink::bytes_sent() const noexcept {
  return impl_->bytes_sent;
}
std::uint64_t ClientLink::bytes_received() const noexcept {
  return impl_->bytes_received;
}

struct ServerLink::Impl {
  Impl(const Endpoint& endpoint, const LinkOptions& options) : socket(context, zmq::socket_type::router) {
    set_common_options(socket, endpoint, options);
    socket.set(zmq::sockopt::router_mandatory, true);
    socket.set(zmq::sockopt::router_handover, false);
    if (options.curve.enabled()) {
      socket.set(zmq::sockopt::curve_server, true);
      set_key(socket, zmq::sockopt::curve_secretkey, options.curve.secret_key, "secret_key");
    }
    refuse_ipc_path_in_use(endpoint);
    bind(endpoint);
  }

  void bind(const Endpoint& endpoint) {
    try {
      socket.bind(endpoint.text);
    } catch (const zmq::error_t& error) {
      if (error.num() == EADDRINUSE) {
        throw MachineError(name_of(endpoint) + " is in use; stop the other process or choose another");
      }
      throw MachineError(name_of(endpoint) + " cannot be bound: " + error.what());
    }
  }

  zmq::context_t context{1};
  zmq::socket_t socket;
};

ServerLink::ServerLink(const std::string& endpoint, const LinkOptions& options)
    : impl_(std::make_unique<Impl>(parse_endpoint(endpoint, LinkEnd::server), options)) {}
ServerLink::~ServerLink() = default;
ServerLink::ServerLink(ServerLink&&) noexcept = default;
ServerLink& ServerLink::operator=(ServerLink&&) noexcept = default;

std::string ServerLink::bound_endpoint() const {
  return impl_->socket.get(zmq::sockopt::last_endpoint);
}

std::optional<ServerLink::Incoming> ServerLink::receive(milliseconds timeout) {
  zmq::message_t parts[2];
  if (!receive_exactly(impl_->socket, parts, timeout)) return {};
  return Incoming{parts[0].to_string(), frame_of(std::move(parts[1]))};
}

bool ServerLink::send(const PeerId& peer, const Bytes& frame) {
  // ROUTER decides about the whole message by its first part: the second one cannot be refused.
  return send_part(impl_->socket, zmq::buffer(peer), zmq::send_flags::sndmore) &&
         send_part(impl_->socket, zmq::buffer(frame));
}

}  // namespace sightline
