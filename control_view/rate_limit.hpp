#pragma once

#include <cstddef>
#include <string>
#include <unordered_map>

namespace sightline {

/// Lets one thing happen per interval and key: a log line, a refusal. Holds at most `k_max_keys` keys, so
/// that a peer that reconnects under ever new names cannot grow it; beyond that everybody new has to wait.
class RateLimit {
 public:
  static constexpr std::size_t k_max_keys = 1024;

  explicit RateLimit(double interval_s) : interval_s_(interval_s) {}

  /// Whether it may happen now; if so, it is taken to happen.
  bool take(const std::string& key, double now_s) {
    const auto known = last_s_.find(key);
    if (known != last_s_.end()) {
      if (now_s - known->second < interval_s_) return false;
      known->second = now_s;
      return true;
    }
    if (last_s_.size() >= k_max_keys) {
      std::erase_if(last_s_, [&](const auto& entry) { return now_s - entry.second >= interval_s_; });
      if (last_s_.size() >= k_max_keys) return false;
    }
    last_s_.emplace(key, now_s);
    return true;
  }

 private:
  double interval_s_;
  std::unordered_map<std::string, double> last_s_;
};

}  // namespace sightline
