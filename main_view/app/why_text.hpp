#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/scene/scene.hpp"
#include "main_view/client/culling_core.hpp"
#include "protocol/messages.hpp"

namespace sightline {

/// What the client made of an object in one frame, before anybody is asked why.
struct ClientVerdict {
  bool in_frustum = false;  ///< its bounds may reach into the view
  bool drawn = false;
  bool in_set = false;  ///< a set in use holds it
  Fallback fallback = Fallback::no_set;
};

/// `world_bounds`: the object's. The same conservative tests that the draw list is made by.
[[nodiscard]] ClientVerdict verdict_of(ObjectId id, const Aabb& world_bounds, std::span<const Eye> eyes,
                                       const FrameDecision& decision);

/// One fact: a word for scripts, and what there is to say.
struct WhyLine {
  std::string key;
  std::string text;
};

/// What the client did and why.
[[nodiscard]] WhyLine line_of(const ClientVerdict& verdict);

/// The daemon's answer: state, what it means, pixels, and a line for each object that hides it, with its name
/// and its share of all pixels the answer speaks of.
[[nodiscard]] std::vector<WhyLine> lines_of(const WhyAnswer& answer, const Scene& scene);

/// `12 "Wall"`, or `12` for one without a name. Control characters are left out.
[[nodiscard]] std::string called(ObjectId id, const Scene& scene);

/// The object that a person means by an id or a name of the scene. Throws InputError where it is neither, or
/// the name of several: with the ids of some of them.
[[nodiscard]] ObjectId find_object(const Scene& scene, std::string_view text);

[[nodiscard]] const char* to_string(WhyState state) noexcept;

}  // namespace sightline
