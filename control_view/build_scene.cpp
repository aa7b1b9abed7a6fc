#include "control_view/build_scene.hpp"

#include <exception>
#include <utility>

#include <malloc.h>

#include "control_view/decode_scene.hpp"
#include "protocol/scene_data.hpp"

namespace sightline {
namespace {

/// What of the scene the offer did not say, or said wrongly; empty when nothing.
std::string fault_of(const SceneData& data, const SceneOffer& offer) {
  if (std::string excess = excess_of(data); !excess.empty()) return excess;
  if (data.object_count() != offer.object_count) {
    return "object_count: the offer says " + std::to_string(offer.object_count) + ", the scene has " +
           std::to_string(data.object_count());
  }
  if (data.triangle_count() != offer.triangle_count) {
    return "triangle_count: the offer says " + std::to_string(offer.triangle_count) + ", the scene has " +
           std::to_string(data.triangle_count());
  }
  return {};
}

std::variant<ServedScenePtr, std::string> scene_or_fault(FinishedUpload upload,
                                                         const MakeEngine& make_engine) {
  auto decoded = decode_scene_data(upload.bytes.all());
  if (const auto* error = std::get_if<DecodeError>(&decoded)) return error->reason;
  upload.bytes = {};  // from here on there is one copy of the scene, not two
  SceneData data = std::get<SceneData>(std::move(decoded));
  if (std::string fault = fault_of(data, upload.offer); !fault.empty()) return fault;
  auto served = std::make_shared<ServedScene>();
  served->identity = {upload.offer.scene_digest, upload.offer.object_count};
  served->roles = SceneRoles(data.objects);
  served->byte_count = upload.offer.byte_count;
  served->engine = make_engine(scene_of(std::move(data), "uploaded scene"));
  return served;
}

}  // namespace

BuiltScene build_scene(FinishedUpload upload, const MakeEngine& make_engine) {
  BuiltScene built{upload.offer.scene_digest, {}};
  try {
    built.result = scene_or_fault(std::move(upload), make_engine);
  } catch (const std::exception& error) {  // bad values, or more memory than there is
    built.result = std::string(error.what());
  }
  malloc_trim(0);
  return built;
}

}  // namespace sightline
