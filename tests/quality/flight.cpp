#include <algorithm>
#include <cstdio>
#include <sstream>

#include "tests/quality/virtual_service.hpp"

namespace sightline::testing {
namespace {

constexpr int k_named_frames = 5;   // of those wrong, in a failure's text
constexpr int k_named_objects = 4;  // of one of those

/// Changes beyond the truth's that an object may make: one that is nearly seen may come and go once.
constexpr std::uint32_t k_extra_changes = 2;

/// What was drawn and visible of every object that two frames in a row had in their frustum.
class ChangeCounter {
 public:
  explicit ChangeCounter(std::uint32_t object_count) : states_(object_count) {}

  void add(const VirtualService& service, std::map<ObjectId, StateChanges>& changes) {
    ++frame_;
    for (const ObjectId id : service.in_frustum()) {
      State& state = states_[index_of(id)];
      const State now{frame_, holds(service.drawn(), id), holds(service.truth().ids, id)};
      if (state.frame + 1 == frame_ && frame_ > 1) {
        if (now.drawn != state.drawn) ++changes[id].drawn;
        if (now.visible != state.visible) ++changes[id].truly;
      }
      state = now;
    }
  }

 private:
  struct State {
    std::uint32_t frame = 0;
    bool drawn = false, visible = false;
  };
  static bool holds(const std::vector<ObjectId>& ids, ObjectId id) {
    return std::binary_search(ids.begin(), ids.end(), id);
  }
  std::vector<State> states_;
  std::uint32_t frame_ = 0;
};

auto first_answered(const FlightOutcome& outcome) {
  return std::find_if(outcome.frames.begin(), outcome.frames.end(),
                      [](const FrameOutcome& frame) { return frame.fallback == Fallback::none; });
}

/// Mean of `drawn` / visible objects from the first answer on, over the frames that show anything.
double mean_over_visible(const FlightOutcome& outcome, std::uint32_t FrameOutcome::*drawn) {
  double sum = 0.0;
  int count = 0;
  for (auto frame = first_answered(outcome); frame != outcome.frames.end(); ++frame) {
    if (frame->visible_objects == 0) continue;
    sum += static_cast<double>((*frame).*drawn) / frame->visible_objects;
    ++count;
  }
  return count == 0 ? 0.0 : sum / count;
}

::testing::AssertionResult verdict(bool passed) {
  return passed ? ::testing::AssertionSuccess() : ::testing::AssertionFailure();
}

}  // namespace

std::uint32_t FlightOutcome::wrong_frames() const {
  return static_cast<std::uint32_t>(std::count_if(
      frames.begin(), frames.end(), [](const FrameOutcome& frame) { return !frame.missed.empty(); }));
}

std::uint64_t FlightOutcome::wrong_pixels() const {
  std::uint64_t sum = 0;
  for (const FrameOutcome& frame : frames) sum += frame.wrong_pixels;
  return sum;
}

double FlightOutcome::conservativity() const {
  return mean_over_visible(*this, &FrameOutcome::drawn_objects);
}

double FlightOutcome::conservativity_of_the_frustum() const {
  return mean_over_visible(*this, &FrameOutcome::in_frustum_objects);
}

std::uint32_t FlightOutcome::fallbacks_after_first_answer() const {
  return static_cast<std::uint32_t>(
      std::count_if(first_answered(*this), frames.end(),
                    [](const FrameOutcome& frame) { return frame.fallback != Fallback::none; }));
}

std::uint32_t FlightOutcome::restless_objects() const {
  return static_cast<std::uint32_t>(std::count_if(changes.begin(), changes.end(), [](const auto& change) {
    return change.second.drawn > change.second.truly + k_extra_changes;
  }));
}

std::string FlightOutcome::summary() const {
  char text[240];
  std::snprintf(
      text, sizeof text,
      "%zu frames, %u wrong, %llu wrong pixels, conservativity %.3f of %.3f, %u fallbacks, %u restless",
      frames.size(), wrong_frames(), static_cast<unsigned long long>(wrong_pixels()), conservativity(),
      conservativity_of_the_frustum(), fallbacks_after_first_answer(), restless_objects());
  return text;
}

FlightOutcome fly(const Scene& scene, const Motion& motion, double duration_s, const ServiceSetup& setup) {
  VirtualService service(scene, setup);
  ChangeCounter changes(scene.object_count());
  FlightOutcome outcome;
  const int frame_count = static_cast<int>(duration_s * setup.frame_rate_hz);
  bool answered = false;
  for (int frame = 0; frame < frame_count; ++frame) {
    outcome.frames.push_back(service.step(motion(frame / setup.frame_rate_hz)));
    // Until the first answer everything in the frustum is drawn: what goes then is no flicker.
    if (answered) changes.add(service, outcome.changes);
    answered = answered || outcome.frames.back().fallback == Fallback::none;
  }
  return outcome;
}

::testing::AssertionResult has_at_most_wrong_frames(std::uint32_t frames, const FlightOutcome& outcome) {
  if (outcome.wrong_frames() <= frames) return ::testing::AssertionSuccess();
  std::ostringstream text;
  text << outcome.summary() << "; known " << frames;
  int named = 0;
  for (const FrameOutcome& frame : outcome.frames) {
    if (frame.missed.empty()) continue;
    if (named++ == k_named_frames) break;
    text << "\n  at " << frame.time_s << " s:";
    int objects = 0;
    for (const auto& [id, pixels] : frame.missed) {
      if (objects++ == k_named_objects) break;
      text << " object " << index_of(id) << " (" << pixels << " pixels)";
    }
    if (frame.missed.size() > k_named_objects)
      text << " and " << frame.missed.size() - k_named_objects << " more";
  }
  return ::testing::AssertionFailure() << text.str();
}

::testing::AssertionResult falls_back_at_most(std::uint32_t frames, const FlightOutcome& outcome) {
  const bool answered = first_answered(outcome) != outcome.frames.end();
  return verdict(answered && outcome.fallbacks_after_first_answer() <= frames)
         << outcome.summary() << "; known " << frames;
}

::testing::AssertionResult keeps_at_most(double conservativity, const FlightOutcome& outcome) {
  // Nothing visible at all would be no test.
  const double kept = outcome.conservativity();
  return verdict(kept > 0.0 && kept <= conservativity) << outcome.summary() << "; allowed " << conservativity;
}

::testing::AssertionResult has_at_most_restless_objects(std::uint32_t objects, const FlightOutcome& outcome) {
  std::ostringstream text;
  int named = 0;
  for (const auto& [id, change] : outcome.changes) {
    if (change.drawn <= change.truly + k_extra_changes || named++ >= k_named_objects) continue;
    text << "\n  object " << index_of(id) << " changed " << change.drawn << " times, truly " << change.truly;
  }
  return verdict(outcome.restless_objects() <= objects)
         << outcome.summary() << "; known " << objects << text.str();
}

}  // namespace sightline::testing
