#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "main_view/client/moving_objects.hpp"

namespace sightline {
namespace {

constexpr std::uint32_t k_declared = 24;  ///< ids from here on are spares
constexpr std::uint32_t k_ids = 32;
const Aabb k_bounds{{-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}};

/// What an object is, plainly: as the application has it, or as a request says.
struct Thing {
  enum class Sort { gone, geometry, box } sort = Sort::gone;
  glm::dvec3 place_m{0.0};  ///< of geometry
  WorldBox bounds;

  bool operator==(const Thing&) const = default;
};

glm::dmat4x3 placement(const glm::dvec3& place_m) {
  glm::dmat4x3 matrix(1.0);
  matrix[3] = place_m;
  return matrix;
}

bool holds(const WorldBox& outer, const WorldBox& inner) {
  return excess_m(outer, inner) == 0.0;
}

/// Beside MovingObjects the plain account: every object as it is, and what the daemon knows by each request.
class Model {
 public:
  explicit Model(std::uint32_t seed) : random_(seed) {
    std::vector<MovedObject> declared;
    for (std::uint32_t id = 0; id < k_declared; ++id) {
      const glm::dvec3 place_m(4.0 * id, 0.0, -10.0);
      truth_[id] = {Thing::Sort::geometry, place_m, geometry_bounds(place_m)};
      declared.push_back({ObjectId{id}, placement(place_m), k_bounds});
      file_.push_back(truth_[id]);
      placed_.push_back(place_m);
    }
    for (std::uint32_t id = k_declared; id < k_ids; ++id) {
      truth_[id] = {};
      file_.emplace_back();
      placed_.emplace_back(0.0);
    }
    moving_.declare(declared);
    daemon_ = file_;
    hidden_.resize(k_ids, false);
    boxed_.resize(k_ids, false);
  }

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  std::uint32_t below(std::uint32_t count) {
    return std::uniform_int_distribution<std::uint32_t>(0, count - 1)(random_);
  }
  bool chance(double probability) { return uniform(0.0, 1.0) < probability; }

  void step() {
    const double last_s = now_s_;
    now_s_ += 1.0 / 60.0;
    edit(last_s);
    if (chance(0.02)) lose_the_daemon();
    if (chance(0.8)) request();
    if (chance(0.7)) answer();
    check();
  }

  std::size_t drawn_ = 0, questions_ = 0, boxes_ = 0, moves_ = 0, everything_ = 0;

 private:
  static WorldBox geometry_bounds(const glm::dvec3& place_m) {
    return ObjectMotion(k_bounds, placement(place_m)).bounds();
  }

  void edit(double last_s) {
    std::vector<MovedObject> moved;
    std::vector<BoxedPlacement> boxed;
    for (std::uint32_t i = 0; i < k_ids; ++i) {
      const ObjectId id{i};
      // Of a spare nothing is said before it is boxed.
      if (chance(0.01) && (i < k_declared || boxes_of_.count(i) != 0)) {
        hidden_[i] = !hidden_[i];
        if (hidden_[i]) {
          EXPECT_TRUE(moving_.hide({&id, 1}));
        } else {
          moving_.show({&id, 1});
        }
      }
      // A few are restless, the others move now and then.
      if (i < k_declared && !boxed_[i] && chance(i % 4 == 0 ? 0.9 : 0.03)) {
        placed_[i] += glm::dvec3(0.05, 0.0, chance(0.05) ? uniform(-3.0, 3.0) : 0.0);
        moved.push_back({id, placement(placed_[i]), k_bounds});
      } else if (i % 3 == 0 && chance(boxed_[i] ? 0.7 : 0.02)) {
        const glm::dvec3 low(uniform(-1.0, 0.0) + i, uniform(-0.1, 0.0), -5.0 + now_s_);
        boxed.push_back({id, {low, low + glm::dvec3(1.0, uniform(0.5, 2.0), 1.0)}});
        boxes_of_[i] = boxed.back().world_bounds;
        boxed_[i] = true;
      }
    }
    EXPECT_TRUE(moving_.move(now_s_, last_s, moved));
    EXPECT_TRUE(moving_.box(now_s_, last_s, boxed));
    const auto at = below(k_ids);
    if (boxed_[at] && chance(0.05)) {
      const ObjectId id{at};
      moving_.unbox({&id, 1});
      boxed_[at] = false;
      if (at >= k_declared) hidden_[at] = true;
    }
    for (std::uint32_t i = 0; i < k_ids; ++i) {
      if (hidden_[i] || (i >= k_declared && !boxed_[i])) {
        truth_[i] = {};
      } else if (boxed_[i]) {
        truth_[i] = {Thing::Sort::box, {}, boxes_of_[i]};
      } else {
        truth_[i] = {Thing::Sort::geometry, placed_[i], geometry_bounds(placed_[i])};
      }
    }
  }

  void lose_the_daemon() {
    moving_.forget_told();
    daemon_ = file_;
    absent_to_daemon_.clear();
    in_flight_.clear();
    filed_.clear();
  }

  /// The request as the daemon takes it: moves and presence stay, boxes are this request's alone.
  void request() {
    ViewRequest request;
    request.request_seq = ++seq_;
    request.for_time_s = now_s_ + 0.05;
    request.eyes = {Eye{glm::dmat4(1.0), clip_from_camera(Perspective{}, 1.0)}};
    moving_.write(request, now_s_, {now_s_ + 0.02, now_s_ + 0.12, 0.03, 2.0});
    for (std::size_t i = 1; i < request.boxed.size(); ++i)
      ASSERT_LT(request.boxed[i - 1].id, request.boxed[i].id);
    for (std::size_t i = 1; i < request.presence.size(); ++i)
      ASSERT_LT(request.presence[i - 1].id, request.presence[i].id);
    for (std::uint32_t i = 0; i < k_ids; ++i) {
      const auto boxed = std::find_if(request.boxed.begin(), request.boxed.end(),
                                      [&](const BoxedObject& box) { return index_of(box.id) == i; });
      ASSERT_TRUE(truth_[i].sort != Thing::Sort::box || boxed != request.boxed.end());
      ASSERT_TRUE(truth_[i].sort != Thing::Sort::gone || boxed == request.boxed.end());
    }
    boxes_ += request.boxed.size();
    moves_ += request.moves.size();
    in_flight_.push_back(std::move(request));
  }

  /// Some requests are superseded by newer ones and never seen.
  void answer() {
    if (in_flight_.size() < 3) return;
    const std::size_t at = chance(0.8) ? 0 : 1;
    const ViewRequest request = in_flight_[at];
    in_flight_.erase(in_flight_.begin(), in_flight_.begin() + static_cast<std::ptrdiff_t>(at) + 1);
    for (const ObjectMove& move : request.moves) {
      ASSERT_LT(index_of(move.id), k_declared);
      const glm::dvec3 place_m = move.world_from_object[3];
      daemon_[index_of(move.id)] = {Thing::Sort::geometry, place_m, geometry_bounds(place_m)};
    }
    for (const ObjectPresence& presence : request.presence) {
      if (presence.present) absent_to_daemon_.erase(index_of(presence.id));
      if (!presence.present) absent_to_daemon_.insert(index_of(presence.id));
    }
    std::vector<Thing> known = daemon_;
    for (const BoxedObject& box : request.boxed)
      known[index_of(box.id)] = {Thing::Sort::box, {}, box.world_bounds};
    for (const std::uint32_t id : absent_to_daemon_) known[id] = {};
    moving_.acknowledge(request.request_seq);
    filed_.push_back({{request, VisibleSet(), {}}, std::move(known)});
    if (filed_.size() > 6) filed_.erase(filed_.begin());
  }

  /// Against the last two sets: what they know wrong must be drawn, with all that it hid; nothing else.
  void check() {
    std::vector<const FiledSet*> used;
    const std::size_t first = filed_.size() > 2 ? filed_.size() - 2 : 0;
    for (std::size_t i = first; i < filed_.size(); ++i) used.push_back(&filed_[i].filed);
    const MovedInFrame moved = moving_.judge(used);
    everything_ += moved.everything;
    for (std::uint32_t i = 0; i < k_ids; ++i) {
      const bool listed_absent = moved.is_absent(ObjectId{i});
      ASSERT_EQ(listed_absent, static_cast<bool>(hidden_[i])) << "object " << i << " at " << now_s_;
      bool wrong = false;
      for (std::size_t k = first; k < filed_.size(); ++k) {
        const Thing& known = filed_[k].known[i];
        const bool in_its_box = known.sort == Thing::Sort::box && holds(known.bounds, truth_[i].bounds);
        if (!(known == truth_[i]) && !in_its_box) wrong = true;
        // Where it hid something and does no more.
        if (known.sort != Thing::Sort::geometry || known == truth_[i]) continue;
        const glm::vec3 along = glm::vec3(0.5 * (known.bounds.min + known.bounds.max)) * 3.0f;
        EXPECT_TRUE(moved.must_draw(ObjectId{k_ids}, {along - 0.01f, along + 0.01f})) << i;
      }
      if (truth_[i].sort == Thing::Sort::gone) continue;
      const bool drawn =
          moved.everything || std::binary_search(moved.untested.begin(), moved.untested.end(), ObjectId{i});
      ASSERT_TRUE(drawn || !wrong) << "object " << i << " at " << now_s_;
      ++questions_;
      drawn_ += drawn && !wrong;  // more than needed: see below
    }
  }

  struct Known {
    FiledSet filed;
    std::vector<Thing> known;
  };

  std::mt19937 random_;
  MovingObjects moving_;
  double now_s_ = 0.0;
  std::uint64_t seq_ = 0;
  std::map<std::uint32_t, Thing> truth_;
  std::map<std::uint32_t, WorldBox> boxes_of_;
  std::vector<Thing> file_, daemon_;
  std::vector<glm::dvec3> placed_;
  std::set<std::uint32_t> absent_to_daemon_;
  std::vector<bool> hidden_, boxed_;
  std::vector<ViewRequest> in_flight_;
  std::vector<Known> filed_;
};

TEST(MovingObjectsModel, DrawsWhateverASetKnowsWrongAndHardlyAnythingElse) {
  std::size_t questions = 0, needless = 0, boxes = 0, moves = 0, everything = 0;
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    Model model(seed);
    for (int frame = 0; frame < 300 && !::testing::Test::HasFailure(); ++frame) model.step();
    questions += model.questions_;
    needless += model.drawn_;
    boxes += model.boxes_;
    moves += model.moves_;
    everything += model.everything_;
  }
  EXPECT_LT(needless, questions / 50);
  EXPECT_EQ(everything, 0u);
  EXPECT_GT(boxes, 10'000u);
  EXPECT_GT(moves, 500u);
}

}  // namespace
}  // namespace sightline
