#include "main_view/app/quality.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "common/statistics.hpp"

namespace sightline {

nlohmann::ordered_json quality_of(const std::vector<FrameRecord>& frames, std::uint32_t object_count,
                                  std::uint64_t triangle_count, std::uint32_t depth_frustum_max,
                                  std::uint32_t depth_drawn_max) {
  std::vector<double> wrong, missed, conservativity, all, frustum, drawn, oracle;
  std::vector<double> drawn_changes, true_changes;
  std::uint64_t drawn_total = 0, visible_total = 0, fallbacks = 0, wrong_frames = 0;
  double last_fallback_s = -1.0;
  for (const FrameRecord& frame : frames) {
    const FrameVerdict& v = frame.verdict;
    wrong.push_back(static_cast<double>(v.wrong_pixels) / static_cast<double>(v.pixels));
    wrong_frames += v.wrong_pixels > 0;
    missed.push_back(v.missed_objects);
    if (v.visible_objects > 0) {
      conservativity.push_back(double(v.drawn_objects) / double(v.visible_objects));
      drawn_total += v.drawn_objects;
      visible_total += v.visible_objects;
    }
    all.push_back(static_cast<double>(v.triangles_all));
    frustum.push_back(static_cast<double>(v.triangles_frustum));
    drawn.push_back(static_cast<double>(v.triangles_drawn));
    oracle.push_back(static_cast<double>(v.triangles_oracle));
    if (&frame != &frames.front()) {
      drawn_changes.push_back(frame.drawn_changes);
      true_changes.push_back(frame.true_changes);
    }
    if (frame.fallback) {
      ++fallbacks;
      last_fallback_s = frame.time_s - frames.front().time_s;
    }
  }
  nlohmann::ordered_json quality;
  quality["frames"] = frames.size();
  quality["objects"] = object_count;
  quality["triangles"] = triangle_count;
  quality["wrong_pixels_mean"] = mean_of(wrong);
  quality["wrong_pixels_p99"] = quantile_of(wrong, 0.99);
  quality["wrong_pixels_max"] = max_of(wrong);
  quality["frames_with_wrong_pixels"] = wrong_frames;
  quality["missed_objects_mean"] = mean_of(missed);
  quality["missed_objects_max"] = max_of(missed);
  quality["conservativity_mean"] = mean_of(conservativity);
  quality["conservativity_p99"] = quantile_of(conservativity, 0.99);
  quality["conservativity_total"] = visible_total > 0 ? double(drawn_total) / double(visible_total) : 0.0;
  quality["fallback_frames"] = fallbacks;
  quality["fallback_last_s"] = last_fallback_s;  // seconds into the run; -1 when there was none
  quality["state_changes_drawn_mean"] = mean_of(drawn_changes);
  quality["state_changes_true_mean"] = mean_of(true_changes);
  quality["triangles_all"] = mean_of(all);
  quality["triangles_frustum"] = mean_of(frustum);
  quality["triangles_drawn"] = mean_of(drawn);
  quality["triangles_oracle"] = mean_of(oracle);
  quality["depth_complexity_frustum_max"] = depth_frustum_max;
  quality["depth_complexity_drawn_max"] = depth_drawn_max;
  return quality;
}

}  // namespace sightline
