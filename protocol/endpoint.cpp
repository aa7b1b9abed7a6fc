#include "protocol/endpoint.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <string_view>

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "common/error.hpp"
#include "protocol/clean_text.hpp"

namespace sightline {
namespace {

constexpr std::string_view k_tcp_scheme = "tcp://";
constexpr std::string_view k_ipc_scheme = "ipc://";

[[noreturn]] void refuse(const std::string& text, const std::string& why) {
  throw InputError("endpoint '" + clean_text(text) + "': " + why);
}

bool is_host_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-' ||
         c == '_';
}

bool is_ipv6_character(char c) {
  return (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F') || (c >= '0' && c <= '9') || c == ':' || c == '.';
}

bool is_port(std::string_view text) {
  unsigned port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  return error == std::errc{} && end == text.data() + text.size() && port >= 1 && port <= 65535;
}

Endpoint parse_tcp(const std::string& text, LinkEnd end) {
  const std::string_view rest = std::string_view(text).substr(k_tcp_scheme.size());
  const std::size_t colon = rest.rfind(':');
  if (colon == std::string_view::npos) refuse(text, "has no port; write tcp://HOST:PORT");
  const std::string_view host = rest.substr(0, colon);
  const std::string_view port = rest.substr(colon + 1);

  const bool wildcard_port = end == LinkEnd::server && (port == "*" || port == "0");
  if (!wildcard_port && !is_port(port)) refuse(text, "the port must be 1 to 65535");

  const bool wildcard_host = end == LinkEnd::server && host == "*";
  const bool bracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
  const bool ipv6_literal = bracketed && std::all_of(host.begin() + 1, host.end() - 1, is_ipv6_character);
  const bool name = !host.empty() && std::all_of(host.begin(), host.end(), is_host_character);
  if (!wildcard_host && !ipv6_literal && !name) {
    refuse(text, end == LinkEnd::client ? "the host must be a name, an IPv4 address or an [IPv6] address"
                                        : "the host must be *, a name, an IPv4 address or an [IPv6] address");
  }
  return Endpoint{text, Transport::tcp, std::string(host), {}};
}

Endpoint parse_ipc(const std::string& text, LinkEnd end) {
  const std::string path = text.substr(k_ipc_scheme.size());
  if (path.empty()) refuse(text, "has no path; write ipc://PATH");
  // Anybody on the machine may connect to an abstract socket, and its name can be mistaken for a file's.
  if (path.front() == '@') refuse(text, "abstract sockets (@) are not supported; write ipc://PATH");
  if (path == "*" && end == LinkEnd::client) refuse(text, "a client cannot connect to a wildcard");
  if (!is_clean_text(path)) refuse(text, "the path holds control characters or is not UTF-8");
  if (path.size() >= sizeof(sockaddr_un::sun_path)) {
    refuse(text, "the path is longer than " + std::to_string(sizeof(sockaddr_un::sun_path) - 1) + " bytes");
  }
  return Endpoint{text, Transport::ipc, {}, path};
}

/// 0 when something listens on the socket file, else errno.
int probe_listener(const std::string& path) {
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (probe < 0) return errno;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.data(), path.size());
  const int result = ::connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  const int error = result == 0 ? 0 : errno;
  ::close(probe);
  return error;
}

}  // namespace

Endpoint parse_endpoint(const std::string& text, LinkEnd end) {
  if (text.starts_with(k_tcp_scheme)) return parse_tcp(text, end);
  if (text.starts_with(k_ipc_scheme)) return parse_ipc(text, end);
  refuse(text, "must begin with tcp:// or ipc://");
}

void refuse_ipc_path_in_use(const Endpoint& endpoint) {
  if (endpoint.transport != Transport::ipc || endpoint.path == "*") return;

  struct stat status {};
  if (::lstat(endpoint.path.c_str(), &status) != 0) return;  // nothing there: bind says what else is wrong
  if (!S_ISSOCK(status.st_mode)) {
    throw MachineError("endpoint '" + endpoint.text +
                       "': the file exists and is no socket; choose another path");
  }
  const int error = probe_listener(endpoint.path);
  if (error == ECONNREFUSED) return;  // left behind by a process that is gone
  if (error == 0 || error == EAGAIN) {
    throw MachineError("endpoint '" + endpoint.text +
                       "' is in use; stop the other process or choose another");
  }
  throw MachineError("endpoint '" + endpoint.text +
                     "': cannot tell whether it is in use: " + std::strerror(error));
}

}  // namespace sightline
