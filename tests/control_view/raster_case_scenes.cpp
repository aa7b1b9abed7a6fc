#include "tests/control_view/raster_case_scenes.hpp"

#include <cmath>

#include <glm/ext/matrix_transform.hpp>

#include "tests/common/test_scenes.hpp"

namespace sightline::test {
namespace {

constexpr float k_sub_pixel = 1.0f / 256.0f;

using testing::SceneBuilder;

TriangleSoup::Side either_side(Dice& dice) {
  return dice.one_in(2) ? TriangleSoup::single_sided : TriangleSoup::double_sided;
}

/// A placement near the identity; every third one mirrors.
glm::dmat4 some_placement(Dice& dice) {
  glm::dmat4 placement = glm::translate(glm::dmat4(1.0), glm::dvec3(dice.in_cube(1.0f)));
  placement = glm::rotate(placement, double(dice.between(-0.5f, 0.5f)), glm::dvec3(0.6, 0.0, 0.8));
  return dice.one_in(3) ? glm::scale(placement, glm::dvec3(-1.0, 1.0, 1.3)) : placement;
}

glm::vec3 ahead(Dice& dice) {
  const float depth = dice.between(3.0f, 25.0f);
  return {dice.between(-0.8f, 0.8f) * depth, dice.between(-0.6f, 0.6f) * depth, -depth};
}

}  // namespace

Scene soup_of(Dice& dice, int count, float size_m) {
  TriangleSoup soup;
  for (int i = 0; i < count; ++i) {
    const glm::vec3 centre = ahead(dice);
    Triangle triangle;
    for (glm::vec3& corner : triangle) corner = centre + dice.in_cube(size_m);
    soup.add_alone(triangle, either_side(dice), some_placement(dice));
  }
  return soup.finish();
}

Scene slivers(Dice& dice) {
  TriangleSoup soup;
  for (int i = 0; i < 300; ++i) {
    const glm::vec3 a = ahead(dice), b = a + dice.in_cube(8.0f);
    const glm::vec3 c = a + (b - a) * dice.between(-0.5f, 1.5f) + dice.in_cube(0.01f);
    soup.add_alone({a, b, c}, either_side(dice), some_placement(dice));
  }
  return soup.finish();
}

Scene sub_pixel_slivers(Dice& dice) {
  TriangleSoup soup;
  for (int object = 0; object < 8; ++object) {
    soup.begin_object(object % 2 == 0 ? TriangleSoup::single_sided : TriangleSoup::double_sided);
    for (int i = 0; i < 400; ++i) {
      const bool along_row = dice.one_in(2);
      const auto length = static_cast<float>(dice.between(2, 9));
      const glm::vec3 along = along_row ? glm::vec3(length, 0, 0) : glm::vec3(0, length, 0);
      const auto jitter = [&] {
        const float x = dice.between(-0.9f, 0.9f);
        return k_sub_pixel * glm::vec3(x, dice.between(-0.9f, 0.9f), 0.0f);
      };
      const auto column = static_cast<float>(dice.between(12, 140)),
                 row = static_cast<float>(dice.between(12, 105));
      const glm::vec3 start(column + 0.5f, row + 0.5f, -dice.between(1.0f, 6.0f));
      Triangle triangle = {start + jitter(), start + along + jitter(), start + 0.5f * along + jitter()};
      if (object >= 2 && i == std::array{0, 340, 341}[static_cast<std::size_t>(object) % 3])
        triangle[0].x = -3.0f;
      soup.add(triangle);
    }
  }
  return soup.finish();
}

Scene areas_from_snapping(Dice& dice) {
  constexpr float k_half_sub_pixel = 0.5f * k_sub_pixel;
  TriangleSoup soup;
  for (int i = 0; i < 400; ++i) {
    const auto whole = [&](int most) { return static_cast<float>(dice.between(0, most)); };
    // An odd number of half sub-pixels one way and twice as many the other: the ends stay on a line through
    // pixel centres, the middle is snapped away from it.
    const float odd = k_half_sub_pixel * (2.0f * whole(2500) + 1.0f);
    const glm::vec3 step =
        dice.one_in(2) ? glm::vec3(odd, 2.0f * odd, 0.0f) : glm::vec3(2.0f * odd, -odd, 0.0f);
    const glm::vec3 start(whole(100) + 0.5f, whole(50) + 0.5f, -dice.between(1.0f, 19.0f));
    const glm::vec3 tilt(0.0f, 0.0f, dice.one_in(2) ? 0.0f : dice.between(-0.4f, 0.4f));
    Triangle triangle = {start, start + 2.0f * step, start + step + tilt};
    if (dice.one_in(2)) std::swap(triangle[0], triangle[1]);
    soup.add_alone(triangle, either_side(dice));
    if (i % 20 == 0) {
      const glm::vec3 corner(whole(120), whole(60), -dice.between(1.0f, 19.0f));
      soup.add_alone(
          {corner, corner + dice.in_cube(30.0f) * glm::vec3(1, 1, 0), corner - glm::vec3(9, 20, 0)},
          TriangleSoup::double_sided);
    }
  }
  return soup.finish();
}

Scene shared_edges(Dice& dice, bool on_lattice) {
  TriangleSoup soup;
  const auto corner = [&](float x, float y) {
    const float snapped_x = on_lattice ? std::floor(x) + 0.5f : x,
                snapped_y = on_lattice ? std::floor(y) + 0.5f : y;
    return glm::vec3(snapped_x, snapped_y, -5.0f - 0.01f * x + 0.02f * y);
  };
  const glm::vec3 hub = corner(45.0f, 60.0f);
  constexpr int k_spokes = 24;
  std::vector<glm::vec3> rim;
  for (int i = 0; i < k_spokes; ++i) {
    const float angle = 6.2831853f * static_cast<float>(i) / k_spokes, radius = dice.between(20.0f, 44.0f);
    rim.push_back(corner(45.0f + radius * std::cos(angle), 60.0f + radius * std::sin(angle)));
  }
  for (std::size_t i = 0; i < rim.size(); ++i) {
    soup.add_alone({hub, rim[i], rim[(i + 1) % rim.size()]}, TriangleSoup::single_sided);
  }
  std::vector<glm::vec3> strip;
  for (int i = 0; i < 40; ++i) {
    strip.push_back(corner(92.0f + 1.7f * static_cast<float>(i),
                           i % 2 == 0 ? dice.between(5.0f, 50.0f) : dice.between(55.0f, 115.0f)));
  }
  for (std::size_t i = 2; i < strip.size(); ++i) {
    soup.add_alone({strip[i - 2], strip[i - 1], strip[i]}, TriangleSoup::double_sided);
  }
  return soup.finish();
}

Scene lattice(Dice& dice) {
  TriangleSoup soup;
  for (int i = 0; i < 300; ++i) {
    const int reach = dice.between(1, 30), column = dice.between(-8, 168), row = dice.between(-8, 128);
    const bool off_centre = dice.one_in(3);
    Triangle triangle;
    for (glm::vec3& corner : triangle) {
      corner = {static_cast<float>(column + dice.between(-reach, reach)) + 0.5f,
                static_cast<float>(row + dice.between(-reach, reach)) + 0.5f,
                -static_cast<float>(dice.between(1, 6))};
      if (off_centre)
        corner += 0.25f * glm::vec3(float(dice.between(-1, 1)), float(dice.between(-1, 1)), 0.0f);
    }
    soup.add_alone(triangle, either_side(dice));
  }
  return soup.finish();
}

Scene image_corners(Dice& dice) {
  TriangleSoup soup;
  for (int i = 0; i < 120; ++i) {
    const glm::vec3 tip(dice.one_in(2) ? 0.0f : float(k_case_size.width),
                        dice.one_in(2) ? 0.0f : float(k_case_size.height), -dice.between(1.0f, 19.0f));
    const float nudge = 0.5f * static_cast<float>(dice.between(-2, 2));
    soup.add_alone({tip + glm::vec3(nudge, nudge, 0.0f), tip + dice.in_cube(12.0f) * glm::vec3(1, 1, 0),
                    tip + dice.in_cube(12.0f) * glm::vec3(1, 1, 0)},
                   either_side(dice));
  }
  return soup.finish();
}

Scene around_the_eye(Dice& dice, float half_side) {
  TriangleSoup soup;
  for (int i = 0; i < 150; ++i) {
    soup.add_alone({dice.in_cube(half_side), dice.in_cube(half_side), dice.in_cube(half_side)},
                   either_side(dice), some_placement(dice));
  }
  return soup.finish();
}

Scene degenerate(Dice& dice) {
  TriangleSoup soup;
  for (int i = 0; i < 200; ++i) {
    const glm::vec3 a = ahead(dice), b = a + dice.in_cube(3.0f);
    const std::array<glm::vec3, 4> thirds = {a, b, 0.5f * (a + b), a + dice.in_cube(3.0f)};
    const glm::vec3 first = dice.one_in(10) ? glm::vec3(0.0f) : a;
    soup.add_alone({first, b, thirds[static_cast<std::size_t>(i) % thirds.size()]}, either_side(dice));
  }
  return soup.finish();
}

Scene coplanar(Dice& dice) {
  TriangleSoup soup;
  for (int i = 0; i < 40; ++i) {
    const glm::vec3 origin = ahead(dice), right = dice.in_cube(4.0f), up = dice.in_cube(4.0f);
    const glm::vec3 a = origin, b = origin + right, c = origin + right + up, d = origin + up;
    const glm::dmat4 placement = some_placement(dice);
    soup.add_alone({a, b, c}, TriangleSoup::double_sided, placement);
    soup.add_alone({a, b, c}, TriangleSoup::double_sided, placement);
    soup.add_alone({b, c, a}, TriangleSoup::single_sided, placement);
    soup.add_alone({b, d, a}, TriangleSoup::double_sided, placement);
    soup.add_alone({c, d, b}, TriangleSoup::single_sided, placement);
  }
  return soup.finish();
}

Scene glass_and_walls(Dice& dice) {
  SceneBuilder builder;
  const auto stone = builder.add_material(testing::opaque());
  const auto pane = builder.add_material(testing::glass());
  const auto film = builder.add_material(testing::double_sided(testing::glass()));
  for (int i = 0; i < 40; ++i) {
    const glm::dvec3 centre(ahead(dice));
    const double width = dice.between(0.5f, 6.0f), height = dice.between(0.5f, 6.0f),
                 yaw = dice.between(-1.5f, 1.5f);
    const std::uint32_t material = std::array{stone, pane, film}[static_cast<std::size_t>(i) % 3];
    if (dice.one_in(3)) {
      builder.add_box(centre, {width, height, 1.0}, material);
    } else {
      builder.add_wall(centre, width, height, material, yaw);
    }
  }
  return builder.finish();
}

Scene checkers(Dice& dice) {
  SceneBuilder builder;
  const auto stone = builder.add_material(testing::opaque());
  const std::array<std::uint32_t, 3> masks = {builder.add_checker_mask(8), builder.add_checker_mask(5, false),
                                              builder.add_checker_mask(3)};
  for (int i = 0; i < 40; ++i) {
    const glm::dvec3 centre(ahead(dice));
    const std::uint32_t material = i % 4 == 0 ? stone : masks[static_cast<std::size_t>(i) % masks.size()];
    builder.add_wall(centre, dice.between(1.0f, 8.0f), dice.between(1.0f, 8.0f), material,
                     dice.between(-1.6f, 1.6f));
  }
  return builder.finish();
}

Scene masked_noise(Dice& dice) {
  SceneBuilder builder;
  std::vector<std::uint32_t> masks;
  for (std::uint32_t cells = 1; cells <= 6; ++cells) masks.push_back(builder.add_checker_mask(cells));
  for (int i = 0; i < 40; ++i) {
    builder.add_wall(glm::dvec3(ahead(dice)), dice.between(1.0f, 8.0f), dice.between(1.0f, 8.0f),
                     masks[static_cast<std::size_t>(i) % masks.size()], dice.between(-1.6f, 1.6f));
  }
  Scene scene = builder.finish();
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    Texture& texture = scene.textures[i];
    for (std::size_t byte = 3; byte < texture.rgba.size(); byte += 4) {
      texture.rgba[byte] = static_cast<std::uint8_t>(dice.between(0, 255));
    }
    texture.repeat_u = i % 2 == 0;
    texture.repeat_v = i % 3 == 0;
  }
  for (Material& material : scene.materials) {
    material.alpha_cutoff = dice.between(0.2f, 0.6f);
    material.base_color.a = dice.between(0.7f, 1.0f);
  }
  for (glm::vec2& uv : scene.uvs)
    uv = uv * dice.between(0.5f, 3.0f) + glm::vec2(dice.between(-2.0f, 2.0f), 0.3f);
  finish_scene(scene, "masked noise");
  return scene;
}

Scene inside_a_box() {
  SceneBuilder builder;
  const auto stone = builder.add_material(testing::opaque());
  const auto card = builder.add_material(testing::double_sided());
  builder.add_box({0.0, 0.0, 0.0}, {2.0, 2.0, 2.0}, stone);
  builder.add_box({0.1, 0.2, -0.3}, {6.0, 5.0, 7.0}, card);
  builder.add_box({0.0, 0.0, 0.0}, {-9.0, 8.0, 7.5}, card);
  builder.add_box({1.0, 0.0, -2.0}, {0.5, 0.5, 0.5}, stone);
  return builder.finish();
}

Scene moved_away(Scene scene, const glm::dvec3& offset_m) {
  for (Object& object : scene.objects) object.scene_from_object[3] += glm::dvec4(offset_m, 0.0);
  finish_scene(scene, "moved away");
  return scene;
}

}  // namespace sightline::test
