#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "main_view/app/why_text.hpp"
#include "main_view/client/culling_session.hpp"

namespace sightline {

/// The object that a person asked about last, and what there is to say of it so far.
class WhyQuestion {
 public:
  explicit WhyQuestion(const Scene& scene) : scene_(scene) {}

  /// Begins a question. `verdict`: what the client made of the object, where a daemon's sets decided.
  /// `session` may be null.
  void ask(ObjectId id, const std::optional<ClientVerdict>& verdict, CullingSession* session);
  /// Takes the answer where it has come; after the session's own poll.
  void take_answer(CullingSession& session);
  void forget() noexcept { id_.reset(); }

  [[nodiscard]] std::optional<ObjectId> object() const noexcept { return id_; }
  /// For the panel; none without a question.
  [[nodiscard]] std::vector<std::string> lines() const;

 private:
  /// Blockers that fit into a panel.
  static constexpr std::size_t k_most_lines = 14;

  const Scene& scene_;
  std::optional<ObjectId> id_;
  std::optional<ClientVerdict> verdict_;
  std::optional<WhyAnswer> answer_;
  std::uint64_t nonce_ = 0;
  bool sent_ = false;
};

}  // namespace sightline
