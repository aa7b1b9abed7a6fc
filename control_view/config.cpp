#include "control_view/config.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "common/error.hpp"

namespace sightline {
namespace {

using Kind = OptionField::Kind;

std::string type_error(const OptionField& field) {
  switch (field.kind) {
    case Kind::text:
      return "must be a string";
    case Kind::integer:
      return "must be an integer";
    case Kind::number:
      return "must be a number";
    case Kind::on_off:
      return "must be true or false";
  }
  return "has the wrong type";
}

/// The value as the command line would spell it; throws InputError when the type is another.
std::string text_of(const toml::node& node, const OptionField& field) {
  const bool integer = node.is_integer();
  if (field.kind == Kind::text && node.is_string()) return **node.as_string();
  if (field.kind == Kind::on_off && node.is_boolean()) return **node.as_boolean() ? "on" : "off";
  if ((field.kind == Kind::integer || field.kind == Kind::number) && integer) {
    return std::to_string(**node.as_integer());
  }
  if (field.kind == Kind::number && node.is_floating_point()) {
    return fmt::format("{}", **node.as_floating_point());
  }
  throw InputError(type_error(field));
}

void take_from_folder(const std::filesystem::path& folder, std::string& path) {
  if (!path.empty()) path = (folder / path).string();  // an absolute path replaces the folder
}

}  // namespace

void read_config(const std::filesystem::path& file, DaemonOptions& options) {
  const std::string name = file.string();
  std::ifstream stream(file);
  std::ostringstream text;
  if (!stream || !(text << stream.rdbuf())) throw InputError(name + ": cannot be read as a config file");

  toml::table table;
  try {
    table = toml::parse(text.str(), name);
  } catch (const toml::parse_error& error) {
    throw InputError(fmt::format("{}:{}: {}", name, error.source().begin.line, error.description()));
  }

  for (const auto& [toml_key, node] : table) {
    const std::string_view key = toml_key.str();
    const auto fields = daemon_option_fields();
    const auto field = std::find_if(fields.begin(), fields.end(),
                                    [&](const OptionField& candidate) { return candidate.name == key; });
    if (field == fields.end()) throw InputError(name + ": unknown key '" + std::string(key) + "'");
    std::string value;
    try {
      value = text_of(node, *field);
    } catch (const InputError& error) {
      throw InputError(name + ": " + std::string(key) + " " + error.what());
    }
    if (field->name == "scene" || field->name == "keys") take_from_folder(file.parent_path(), value);
    set_option(options, field->name, value, name);
  }
}

}  // namespace sightline
