#pragma once

#include <string>

namespace sightline {

/// Writes a new CURVE key pair to a TOML key file that only its owner may read, and prints the public key.
/// Never writes over a file. Throws InputError naming a file that cannot be created, MachineError where
/// ZeroMQ was built without CURVE.
void write_new_keys(const std::string& file);

}  // namespace sightline
