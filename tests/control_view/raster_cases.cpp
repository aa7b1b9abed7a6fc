#include "tests/control_view/raster_cases.hpp"

#include <utility>

#include <glm/ext/matrix_clip_space.hpp>

#include "tests/control_view/raster_case_scenes.hpp"
#include "tests/gl/random_scene.hpp"

namespace sightline::test {
namespace {

using testing::eye_at;

Eye looking_ahead(const glm::dmat4& projection) {
  return {glm::dmat4(1.0), projection};
}

Eye perspective_eye() {
  return looking_ahead(
      clip_from_camera(Perspective{}, double(k_case_size.width) / double(k_case_size.height)));
}

/// Scene x and y are pixels, z from -0.5 to -20 is seen: positions meet pixel centres exactly.
Eye pixel_eye() {
  return looking_ahead(
      glm::ortho(0.0, double(k_case_size.width), 0.0, double(k_case_size.height), 0.5, 20.0));
}

}  // namespace

std::vector<RasterCase> raster_cases(std::uint32_t seed) {
  Dice dice(seed);
  const Eye eye = perspective_eye(), pixels = pixel_eye();
  const double near_m = 0.1;
  std::vector<RasterCase> cases;
  const auto add = [&](const char* name, Scene scene, const Eye& from, ImageSize size = k_case_size) {
    cases.push_back({name, std::move(scene), from, size});
  };
  add("soup of 300 triangles", soup_of(dice, 300, 2.0f), eye);
  add("soup, tall odd image", soup_of(dice, 300, 2.0f), eye, {67, 131});
  add("soup, image of one pixel", soup_of(dice, 300, 2.0f), eye, {1, 1});
  add("slivers", slivers(dice), eye);
  add("slivers below a sub-pixel", sub_pixel_slivers(dice), pixels);
  add("areas that come from snapping", areas_from_snapping(dice),
      looking_ahead(glm::ortho(0.0, 128.0, 0.0, 64.0, 0.5, 20.0)), {128, 64});
  add("shared edges on pixel centres", shared_edges(dice, true), pixels);
  add("shared edges between pixel centres", shared_edges(dice, false), pixels);
  add("lattice of pixel centres", lattice(dice), pixels);
  add("image corners", image_corners(dice), pixels);
  add("tiny triangles", soup_of(dice, 3000, 0.04f), eye);
  add("huge triangles", soup_of(dice, 60, 60.0f), eye);
  add("enormous triangles", soup_of(dice, 40, 50000.0f), eye);
  add("behind the eye", around_the_eye(dice, 4.0f), eye);
  add("through the near plane", around_the_eye(dice, 0.4f), eye);
  add("degenerate", degenerate(dice), eye);
  add("coplanar ties", coplanar(dice), eye);
  add("masked checkers", checkers(dice), eye);
  add("masked noise", masked_noise(dice), eye);
  add("glass before and behind walls", glass_and_walls(dice), eye);
  add("camera inside boxes", inside_a_box(), eye);
  add("objects of every kind", testing::random_scene(seed, 120), eye_at({0, 0, 14}, 0.1, -0.05, k_case_size));
  add("2,000 km from the origin", moved_away(testing::random_scene(seed + 1, 80), {2.0e6, 0.0, -1.5e6}),
      eye_at({2.0e6, 0.0, 14.0 - 1.5e6}, 0.0, 0.0, k_case_size));
  add("off-axis projection", soup_of(dice, 200, 2.0f),
      looking_ahead(glm::frustum(-0.02, 0.09, -0.06, 0.03, near_m, 100.0)));
  add("parallel projection", soup_of(dice, 200, 2.0f),
      looking_ahead(glm::ortho(-9.0, 8.0, -6.0, 6.5, 2.0, 21.0)));
  add("without a far plane", soup_of(dice, 100, 300.0f),
      looking_ahead(glm::infinitePerspective(1.0, 4.0 / 3.0, near_m)));
  add("near and far planes close together", soup_of(dice, 300, 3.0f),
      looking_ahead(glm::perspective(1.0, 4.0 / 3.0, 9.0, 11.0)));
  return cases;
}

}  // namespace sightline::test
