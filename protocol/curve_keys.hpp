#pragma once

#include <string>

namespace sightline {

/// CURVE keys, Z85 text of 40 characters each. Empty strings: no encryption.
struct CurveKeys {
  std::string public_key;
  std::string secret_key;
  std::string server_public_key;  ///< client side only
  [[nodiscard]] bool enabled() const noexcept { return !secret_key.empty(); }
};

/// Reads a TOML key file with `public_key`, `secret_key` and, for a client, `server_public_key`.
/// Throws InputError naming the file and the field: not there, not TOML, a field missing, unknown or no key,
/// or a public key that does not belong to the secret key.
[[nodiscard]] CurveKeys read_curve_keys(const std::string& file);

/// A fresh pair; server_public_key is empty. Throws MachineError when ZeroMQ was built without CURVE.
[[nodiscard]] CurveKeys make_curve_keys();

/// Writes what read_curve_keys reads, readable by its owner alone (mode 0600).
/// Never replaces a file: throws InputError when it exists or cannot be created, MachineError when writing
/// fails.
void write_curve_keys(const std::string& file, const CurveKeys& keys);

}  // namespace sightline
