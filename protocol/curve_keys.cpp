#include "protocol/curve_keys.hpp"

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string_view>

#include <fcntl.h>
#include <toml++/toml.h>
#include <unistd.h>
#include <zmq.h>

#include "common/error.hpp"

namespace sightline {
namespace {

constexpr std::size_t k_key_length = 40;         // Z85 characters, for 32 bytes
constexpr std::size_t k_max_file_bytes = 65536;  // no key file is near it; /dev/zero is

using KeyText = std::array<char, k_key_length + 1>;

std::string read_text(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError("key file '" + file + "': cannot be read: " + std::strerror(errno));
  std::string text(k_max_file_bytes + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (stream.bad() || text.empty()) throw InputError("key file '" + file + "': empty or not readable");
  if (text.size() > k_max_file_bytes) throw InputError("key file '" + file + "': too large for a key file");
  return text;
}

/// ZeroMQ's RFC 32.
constexpr std::string_view k_z85_alphabet =
    "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ.-:+=^!/*?&<>()[]{}@%$#";

bool is_key(const std::string& text) {
  std::array<std::uint8_t, 32> bytes{};
  return text.size() == k_key_length && text.find_first_not_of(k_z85_alphabet) == std::string::npos &&
         ::zmq_z85_decode(bytes.data(), text.c_str()) != nullptr;
}

std::string read_key(const toml::table& table, const std::string& file, const char* field, bool required) {
  const toml::node* node = table.get(field);
  if (node == nullptr) {
    if (!required) return {};
    throw InputError("key file '" + file + "': " + field + " is missing");
  }
  std::string key = node->value_or(std::string());
  if (!is_key(key)) {
    throw InputError("key file '" + file + "': " + field + " must be a key of 40 Z85 characters");
  }
  return key;
}

}  // namespace

CurveKeys read_curve_keys(const std::string& file) {
  toml::table table;
  try {
    table = toml::parse(read_text(file));
  } catch (const toml::parse_error& error) {
    std::ostringstream text;
    text << "key file '" << file << "' line " << error.source().begin.line << ": " << error.description();
    throw InputError(text.str());
  }
  for (const auto& [field, node] : table) {
    if (field != "public_key" && field != "secret_key" && field != "server_public_key") {
      throw InputError("key file '" + file + "': unknown field " + std::string(field.str()));
    }
  }
  CurveKeys keys;
  keys.public_key = read_key(table, file, "public_key", true);
  keys.secret_key = read_key(table, file, "secret_key", true);
  keys.server_public_key = read_key(table, file, "server_public_key", false);

  KeyText derived{};
  if (::zmq_curve_public(derived.data(), keys.secret_key.c_str()) == 0 && keys.public_key != derived.data()) {
    throw InputError("key file '" + file + "': public_key does not belong to secret_key");
  }
  return keys;
}

CurveKeys make_curve_keys() {
  KeyText public_key{};
  KeyText secret_key{};
  if (::zmq_curve_keypair(public_key.data(), secret_key.data()) != 0) {
    throw MachineError(std::string("CURVE keys: zmq_curve_keypair: ") + ::zmq_strerror(::zmq_errno()));
  }
  return CurveKeys{public_key.data(), secret_key.data(), {}};
}

void write_curve_keys(const std::string& file, const CurveKeys& keys) {
  std::string text = "# A secret: who has this file can pose as its owner.\n";
  text += "public_key = \"" + keys.public_key + "\"\nsecret_key = \"" + keys.secret_key + "\"\n";
  if (!keys.server_public_key.empty()) text += "server_public_key = \"" + keys.server_public_key + "\"\n";

  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (descriptor < 0 && errno == EEXIST) {
    throw InputError("key file '" + file + "' exists; remove it or choose another name");
  }
  if (descriptor < 0) throw InputError("key file '" + file + "': cannot be created: " + std::strerror(errno));

  const ssize_t written = ::write(descriptor, text.data(), text.size());
  const bool closed = ::close(descriptor) == 0;
  if (written != static_cast<ssize_t>(text.size()) || !closed) {
    ::unlink(file.c_str());
    throw MachineError("key file '" + file + "': cannot be written");
  }
}

}  // namespace sightline
