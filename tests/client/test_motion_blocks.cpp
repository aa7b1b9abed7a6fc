#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "main_view/client/motion_blocks.hpp"
#include "protocol/message_checks.hpp"

namespace sightline {
namespace {

constexpr double k_frame_s = 1.0 / 60.0;
constexpr std::uint32_t k_movers = 43;  // the last block is not full

WorldBox box_in(const BoxRows& rows, std::uint32_t slot) {
  const std::size_t i = MotionBlocks::lane(slot);
  return {{rows.min[0][i], rows.min[1][i], rows.min[2][i]}, {rows.max[0][i], rows.max[1][i], rows.max[2][i]}};
}

/// Walkers, turning walkers, doors, fans, teleporters and what grows, each of its own size and speed.
struct Mover {
  explicit Mover(std::mt19937& random) {
    const auto uniform = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    sort = static_cast<int>(random() % 6);
    home = {uniform(-2000, 2000), uniform(-20, 20), uniform(-2000, 2000)};
    axis = glm::normalize(glm::dvec3(uniform(-1, 1), uniform(0.1, 1), uniform(-1, 1)));
    speed = uniform(0.2, 8.0);
    const glm::vec3 low(uniform(-3, 0), uniform(-3, 0), uniform(-3, 0));
    bounds = {low, low + glm::vec3(uniform(0, 4), uniform(0, 4), uniform(0, 4))};
  }
  [[nodiscard]] glm::dmat4x3 at(double time_s) const {
    const glm::dmat4 there = glm::translate(glm::dmat4(1.0), home);
    const double turn = 0.2 * speed * time_s;
    switch (sort) {
      case 0:
        return glm::dmat4x3(glm::translate(there, axis * (speed * time_s)));
      case 1:
        return glm::dmat4x3(glm::translate(glm::rotate(there, turn, axis), {3, 0, 0}));
      case 2:
        return glm::dmat4x3(glm::translate(glm::rotate(there, std::sin(turn), {0, 1, 0}), {0.7, 0, 0}));
      case 3:
        return glm::dmat4x3(glm::rotate(there, 5.0 * speed * time_s, axis));
      case 4:
        return glm::dmat4x3(glm::translate(there, axis * (5.0 * std::floor(4.0 * time_s))));
      default:
        return glm::dmat4x3(glm::scale(there, glm::dvec3(1.0 + 0.1 * speed * time_s)));
    }
  }

  int sort = 0;
  glm::dvec3 home, axis;
  double speed = 0.0;
  Aabb bounds;
};

/// The blocks beside one ObjectMotion for each object, and what it would have learnt.
class Pair {
 public:
  Pair(const MotionFunctions& functions, std::uint32_t seed) : random_(seed), blocks_(functions) {
    for (std::uint32_t i = 0; i < k_movers; ++i) {
      movers_.emplace_back(random_);
      plain_.emplace_back(movers_.back().bounds, movers_.back().at(0.0));
      blocks_.add(movers_.back().bounds, movers_.back().at(0.0));
    }
    error_m_.resize(k_movers, 0.0);
    since_.resize(k_movers, 0);
  }

  void frame() {
    const double last_frame_s = now_s_;
    now_s_ += k_frame_s;
    move(last_frame_s);
    foretell();
  }

  double most_added_m_ = 0.0;  ///< to a box, relative to its size and way
  double most_learnt_ = 0.0;   ///< more than was to be learnt, a share
  std::size_t foretold_ = 0, fast_ = 0, jumps_ = 0;

 private:
  void learn(std::uint32_t slot, const ForetoldBoxes::Covering& covering) {
    error_m_[slot] *= std::exp2(-k_frame_s);
    for (std::size_t i = 0; i < covering.count; ++i) {
      if (covering.columns[i]->number < since_[slot]) continue;
      error_m_[slot] = std::max(
          error_m_[slot],
          excess_m(box_in(covering.columns[i]->boxes[slot / k_block_lanes], slot), blocks_.bounds(slot)));
    }
    const double learnt_m = blocks_.error_m(slot);
    EXPECT_GE(learnt_m, 0.9999 * error_m_[slot] - 1e-6) << slot;
    EXPECT_LE(learnt_m, 1.01 * error_m_[slot] + 1e-5) << slot;
    error_m_[slot] = learnt_m;
  }

  void move(double last_frame_s) {
    const ForetoldBoxes::Covering covering = columns_.covering(now_s_);
    std::vector<std::uint32_t> order;
    for (std::uint32_t slot = 0; slot < k_movers; ++slot) {
      if (random_() % 10 != 0) order.push_back(slot);
    }
    if (random_() % 4 == 0) std::shuffle(order.begin(), order.end(), random_);
    MotionSteps steps(blocks_, {now_s_, last_frame_s, columns_.next_number()}, covering);
    for (const std::uint32_t slot : order) {
      const glm::dmat4x3 place = movers_[slot].at(now_s_);
      const double changed_s = plain_[slot].course().time_s;
      const bool stood = now_s_ - changed_s > 2.5 * plain_[slot].course().step_s;
      steps.add(slot, movers_[slot].bounds, place, false);
      if (plain_[slot].step(stood ? std::max(changed_s, last_frame_s) : changed_s, now_s_, place)) continue;
      since_[slot] = columns_.next_number();
      ++jumps_;
    }
    steps.flush();
    for (const std::uint32_t slot : order) {
      learn(slot, covering);
      const WorldBox truth = plain_[slot].bounds(), bounds = blocks_.bounds(slot);
      EXPECT_EQ(excess_m(bounds, truth), 0.0) << slot;
      EXPECT_LE(excess_m(truth, bounds), 1e-5 * plain_[slot].radius_m()) << slot;
    }
  }

  void foretell() {
    ForetellTimes times;
    times.now_s = now_s_;
    times.from_s = now_s_ + 0.03;
    times.until_s = now_s_ + 0.11;
    times.rest_s = 0.1;
    ForetoldBoxes::Column* column =
        columns_.begin(now_s_, times.from_s, times.until_s, blocks_.block_count());
    const ForetoldBoxes::Covering covering = columns_.covering(now_s_, column);
    for (std::uint32_t slot = 0; slot < k_movers; ++slot) {  // without news
      if (now_s_ - plain_[slot].course().time_s > 2.5 * plain_[slot].course().step_s) plain_[slot].stop();
    }
    for (std::size_t block = 0; block < blocks_.block_count(); ++block) {
      BoxRows not_kept, asked;
      BoxRows& way = column != nullptr ? column->boxes[block] : not_kept;
      const Foretold found = blocks_.foretell(block, 0xff, times, covering.rows(block), way, asked);
      for (std::uint32_t lane = 0; lane < k_block_lanes; ++lane) {
        const auto slot = static_cast<std::uint32_t>(k_block_lanes * block) + lane;
        if (slot >= k_movers) break;
        if (plain_[slot].course().time_s < now_s_) learn(slot, covering);
        const bool rests = now_s_ - plain_[slot].course().time_s >= 0.1;
        EXPECT_EQ((found.rested >> lane & 1u) != 0, rests) << slot;
        const ObjectMotion::Way plain = plain_[slot].way_between(times.from_s, times.until_s);
        if ((found.turning_fast >> lane & 1u) != 0) {
          ++fast_;
          continue;
        }
        ++foretold_;
        const double scale_m = plain_[slot].radius_m() + plain.speed_m_per_s * 0.11;
        const WorldBox box = box_in(way, slot);
        EXPECT_EQ(excess_m(box, plain.bounds), 0.0) << slot << " sort " << movers_[slot].sort;
        most_added_m_ = std::max(most_added_m_, excess_m(plain.bounds, box) / scale_m);
        const double doubt_m =
            k_error_margin * blocks_.error_m(slot) + k_least_error_of_way * plain.speed_m_per_s * 0.11;
        EXPECT_LE(excess_m(box_in(asked, slot), widened(box, 0.999 * doubt_m)), 0.0) << slot;
        EXPECT_LE(excess_m(widened(box, doubt_m + 0.005 * plain_[slot].radius_m()), box_in(asked, slot)),
                  0.0);
      }
    }
  }

  std::mt19937 random_;
  MotionBlocks blocks_;
  ForetoldBoxes columns_;
  std::vector<Mover> movers_;
  std::vector<ObjectMotion> plain_;
  std::vector<double> error_m_;
  std::vector<std::int32_t> since_;
  double now_s_ = 0.0;
};

TEST(MotionBlocks, ForetellNoLessThanObjectMotionAndHardlyMore) {
  for (const MotionKernel& kernel : motion_kernels()) {
    if (!kernel.runs_here) continue;
    std::size_t foretold = 0, fast = 0, jumps = 0;
    for (std::uint32_t seed = 1; seed <= 6; ++seed) {
      SCOPED_TRACE(std::string(kernel.name) + ", seed " + std::to_string(seed));
      Pair pair(*kernel.functions, seed);
      for (int i = 0; i < 120 && !HasFailure(); ++i) pair.frame();
      EXPECT_LT(pair.most_added_m_, 1e-4);
      foretold += pair.foretold_;
      fast += pair.fast_;
      jumps += pair.jumps_;
    }
    EXPECT_GT(foretold, 20'000u);
    EXPECT_GT(fast, 1'000u);
    EXPECT_GT(jumps, 300u);
  }
}

TEST(MotionBlocks, LeaveTheLanesAloneThatDidNotMove) {
  for (const MotionKernel& kernel : motion_kernels()) {
    if (!kernel.runs_here) continue;
    std::mt19937 random(3);
    MotionBlocks blocks(*kernel.functions);
    std::vector<Mover> movers;
    for (int i = 0; i < 8; ++i) {
      movers.emplace_back(random);
      blocks.add(movers.back().bounds, movers.back().at(0.0));
    }
    const auto step = [&](std::uint32_t slot, double time_s) {
      const ForetoldBoxes::Covering none;
      MotionSteps(blocks, {time_s, time_s - k_frame_s, 1}, none)
          .add(slot, movers[slot].bounds, movers[slot].at(time_s), true);
    };
    step(2, 0.1);
    const WorldBox before = blocks.bounds(2);
    const ObjectMotion motion = blocks.motion(2);
    for (const std::uint32_t slot : {0u, 1u, 3u, 4u, 5u, 6u, 7u}) step(slot, 0.2);
    EXPECT_EQ(blocks.bounds(2), before);
    EXPECT_EQ(blocks.motion(2).course().velocity_m_per_s, motion.course().velocity_m_per_s);
    EXPECT_EQ(blocks.motion(2).course().linear_per_s, motion.course().linear_per_s);
    EXPECT_EQ(blocks.changed_s(2), 0.1);
    EXPECT_EQ(blocks.changed_s(3), 0.2);
  }
}

/// Whatever finite numbers come in, what goes out can be sent: ordered, and within the wire's limits.
TEST(MotionBlocks, AskForBoxesThatCanBeSentWhateverThePlacement) {
  const double numbers[] = {0.0, -0.0, 1e-300, 1e-30, 1.0, -3e7, 1e12, -1e18, 1e30, 1e150, -1e300};
  const double steps_s[] = {0.0, 1e-9, k_frame_s, 1e6};
  constexpr float k_large = std::numeric_limits<float>::max();
  const Aabb shapes[] = {{},
                         {glm::vec3(0), glm::vec3(0)},
                         {glm::vec3(-1), glm::vec3(1)},
                         {glm::vec3(-k_large), glm::vec3(k_large)}};
  for (const MotionKernel& kernel : motion_kernels()) {
    if (!kernel.runs_here) continue;
    std::mt19937 random(11);
    MotionBlocks blocks(*kernel.functions);
    for (std::uint32_t slot = 0; slot < 8; ++slot) blocks.add(shapes[slot % 4], glm::dmat4x3(1.0));
    double now_s = 0.0;
    for (int frame = 0; frame < 4000; ++frame) {
      const double last_s = now_s;
      now_s += steps_s[random() % 4];
      const ForetoldBoxes::Covering none;
      MotionSteps steps(blocks, {now_s, last_s, 1}, none);
      for (std::uint32_t slot = 0; slot < 8; ++slot) {
        glm::dmat4x3 place = blocks.world_from_object(slot);
        if (random() % 3 != 0)
          place[static_cast<int>(random() % 4)][static_cast<int>(random() % 3)] = numbers[random() % 11];
        steps.add(slot, shapes[random() % 4], place, random() % 8 == 0);
      }
      steps.flush();
      BoxRows way, asked;
      (void)blocks.foretell(0, 0xff, {now_s, now_s + 0.01, now_s + 0.1, 0.1}, {}, way, asked);
      for (std::uint32_t slot = 0; slot < 8; ++slot) {
        const WorldBox box = box_in(asked, slot);
        for (int axis = 0; axis < 3; ++axis) {
          ASSERT_GE(box.min[axis], -k_max_matrix_entry);
          ASSERT_LE(box.min[axis], box.max[axis]);
          ASSERT_LE(box.max[axis], k_max_matrix_entry);
        }
      }
    }
  }
}

}  // namespace
}  // namespace sightline
