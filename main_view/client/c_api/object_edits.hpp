#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "main_view/client/c_api/sightline.h"
#include "main_view/client/culling_client.hpp"

namespace sightline::c_api {

// The edits of objects in C's terms: pointers and counts are checked, and every value of a call before the
// first object changes. Each throws Failure, or the client's InputError. `flags_of_objects`: as the client
// has them, by id; kept up to date.

void move_objects(CullingClient& client, bool row_major, const std::uint32_t* ids, const double* matrices,
                  std::size_t count);
void add_objects(CullingClient& client, std::vector<std::uint32_t>& flags_of_objects, bool row_major,
                 const sl_boxed_object* objects, std::size_t count, std::uint32_t* ids);
void remove_objects(CullingClient& client, const std::uint32_t* ids, std::size_t count);
/// Objects that deform, and such as draw other geometry from now on.
void deform_objects(CullingClient& client, const std::uint32_t* ids, const sl_box* boxes, std::size_t count);
void set_always_visible(CullingClient& client, std::vector<std::uint32_t>& flags_of_objects,
                        const std::uint32_t* ids, std::size_t count, bool always);
void show_objects(CullingClient& client, const std::uint32_t* ids, std::size_t count, bool shown);

/// An array of `count` structures, each as large as the first one says. Throws Failure.
[[nodiscard]] std::vector<SceneObject> scene_objects_of(const sl_boxed_object* objects, std::size_t count,
                                                        bool row_major);

}  // namespace sightline::c_api
