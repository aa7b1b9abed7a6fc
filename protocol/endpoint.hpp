#pragma once

#include <string>

namespace sightline {

enum class Transport { tcp, ipc };
enum class LinkEnd { client, server };

/// A checked ZeroMQ address.
struct Endpoint {
  std::string text;  ///< as given
  Transport transport = Transport::tcp;
  std::string host;  ///< tcp: name, IPv4 or [IPv6] address; "*" for every interface (server only)
  std::string path;  ///< ipc: file, "@name" in Linux's abstract namespace, or "*" (server only)

  /// Whether the socket must speak IPv6. Names resolve to IPv4: ZeroMQ tries only the first address of a
  /// name, and "localhost" is often ::1 first while daemons bind to 127.0.0.1.
  [[nodiscard]] bool needs_ipv6() const noexcept { return !host.empty() && host.front() == '['; }
};

/// Reads `tcp://HOST:PORT` or `ipc://PATH`. A server may have * for host, port and path.
/// Throws InputError naming the endpoint for anything else.
[[nodiscard]] Endpoint parse_endpoint(const std::string& text, LinkEnd end);

/// Throws MachineError when binding to an ipc path would steal it from a process that listens there, or
/// delete something that is no socket: ZeroMQ itself unlinks whatever has that name. A socket left by a dead
/// process is no obstacle. Two processes that start in the same instant can still both pass.
void refuse_ipc_path_in_use(const Endpoint& endpoint);

}  // namespace sightline
