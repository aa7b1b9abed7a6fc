#include "control_view/choose_engine.hpp"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "tests/common/test_scenes.hpp"

namespace sightline {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr ImageSize k_size{64, 48};

/// Turns a clock by what each answer is said to cost.
class CostlyEngine final : public VisibilityEngine {
 public:
  CostlyEngine(double& now_s, std::vector<double> costs_s) : now_s_(now_s), costs_s_(std::move(costs_s)) {}
  void apply(const SceneEdits&) override {}
  EngineStats count(const ViewQuery&, PixelCounts& counts) override {
    counts.clear();
    now_s_ += costs_s_[std::min(calls++, costs_s_.size() - 1)];
    return {};
  }
  std::size_t calls = 0;

 private:
  double& now_s_;
  std::vector<double> costs_s_;
};

struct Race {
  double now_s = 0.0;
  std::vector<std::unique_ptr<VisibilityEngine>> engines;
  std::vector<Eye> views = std::vector<Eye>(3);

  CostlyEngine& add(std::vector<double> costs_s) {
    auto engine = std::make_unique<CostlyEngine>(now_s, std::move(costs_s));
    CostlyEngine& added = *engine;
    engines.push_back(std::move(engine));
    return added;
  }
  std::vector<double> run(double budget_s) {
    return measure(engines, views, k_size, budget_s, [this] { return now_s; });
  }
};

Scene one_box() {
  testing::SceneBuilder builder;
  builder.add_box({100, 2, 3}, {1, 1, 1}, builder.add_material(testing::opaque()));
  return builder.finish();
}

std::string refusal_of(EngineOptions options) {
  try {
    (void)resolved(std::move(options));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no InputError";
}

TEST(EngineChoice, LeavesTheFirstAnswerOutOfTheMeasurement) {
  Race race;
  race.add({5.0, 0.25});
  race.add({0.0, 0.5});
  EXPECT_THAT(race.run(100.0), ElementsAre(0.25, 0.5));
}

TEST(EngineChoice, StopsWhenItsTimeIsSpentButMeasuresEachOnce) {
  Race race;
  const CostlyEngine& slow = race.add({9.0});
  const CostlyEngine& quick = race.add({0.125});
  EXPECT_THAT(race.run(0.3), ElementsAre(9.0, 0.125));
  EXPECT_EQ(slow.calls, 2u);
  EXPECT_EQ(quick.calls, 2u);
}

TEST(EngineChoice, KnowsARendererThatIsSoftware) {
  EXPECT_EQ(gl_kind_of("llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5"), GlKind::software);
  EXPECT_EQ(gl_kind_of("softpipe, OpenGL 3.3"), GlKind::software);
  EXPECT_EQ(gl_kind_of("NVIDIA H200/PCIe/SSE2, OpenGL 4.6.0"), GlKind::hardware);
}

TEST(EngineChoice, TriesOnlyExactEngines) {
  for (const GlKind kind : {GlKind::none, GlKind::software, GlKind::hardware}) {
    const auto names = exact_candidates(kind);
    EXPECT_FALSE(names.empty());
    EXPECT_THAT(names, Not(::testing::Contains("raycast")));
  }
  EXPECT_THAT(exact_candidates(GlKind::hardware), ::testing::Contains("item_buffer"));
}

TEST(EngineChoice, LooksOutFromTheMiddleOfTheScene) {
  const Scene scene = one_box();
  const auto views = sample_views(scene, k_size);
  ASSERT_EQ(views.size(), 3u);
  for (const Eye& view : views) {
    const glm::dvec4 middle = view.camera_from_world * glm::dvec4(100, 2, 3, 1);
    EXPECT_NEAR(glm::length(glm::dvec3(middle)), 0.0, 1e-4);
  }
  EXPECT_NE(views[0], views[1]);
  EXPECT_NE(views[1], views[2]);
}

TEST(EngineChoice, NamesTheEngineItTookAndWhatItMeasured) {
  const ChosenEngine chosen =
      choose_engine(one_box(), {.engine = "auto", .counter = ""}, k_size, steady_clock());
  EXPECT_EQ(chosen.options.engine, exact_candidates(GlKind::software).front());
  EXPECT_THAT(chosen.why, AllOf(HasSubstr("engine " + chosen.options.engine), HasSubstr("osmesa"),
                                HasSubstr("64x48"), Not(HasSubstr("\n"))));
  EXPECT_NE(chosen.engine, nullptr);
}

TEST(EngineChoice, TakesTheItemBufferWhereACounterIsNamed) {
  const ChosenEngine chosen =
      choose_engine(one_box(), {.engine = "auto", .counter = "queries"}, k_size, steady_clock());
  EXPECT_EQ(chosen.options.engine, "item_buffer");
  EXPECT_EQ(chosen.options.counter, "queries");
}

TEST(EngineRegistry, FillsInTheFirstCounter) {
  EXPECT_EQ(resolved({.engine = "item_buffer", .counter = ""}).counter, "histogram");
  EXPECT_EQ(resolved({.engine = "item_buffer_all", .counter = "compute"}).counter, "compute");
  EXPECT_EQ(resolved({.engine = "raycast", .counter = ""}).counter, "");
}

TEST(EngineRegistry, RefusesWhatItDoesNotHave) {
  EXPECT_THAT(refusal_of({.engine = "magic", .counter = ""}),
              AllOf(HasSubstr("magic"), HasSubstr("item_buffer_all"), HasSubstr("raycast")));
  EXPECT_THAT(refusal_of({.engine = "item_buffer", .counter = "abacus"}),
              AllOf(HasSubstr("abacus"), HasSubstr("histogram")));
  EXPECT_THAT(refusal_of({.engine = "auto", .counter = "abacus"}), HasSubstr("abacus"));
  EXPECT_THAT(refusal_of({.engine = "raycast", .counter = "queries"}), HasSubstr("raycast"));
}

TEST(EngineRegistry, MakesEveryEngineItLists) {
  const Scene scene = one_box();
  const Eye eye = sample_views(scene, k_size).front();
  for (const EngineEntry& entry : engine_registry()) {
    const auto engine = make_engine(scene, resolved({.engine = std::string(entry.name), .counter = ""}));
    PixelCounts counts;
    engine->count({{&eye, 1}, k_size, {}}, counts);
    EXPECT_LE(counts.ids.size(), 1u) << entry.name;
  }
}

}  // namespace
}  // namespace sightline
