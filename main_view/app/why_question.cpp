#include "main_view/app/why_question.hpp"

#include <algorithm>

namespace sightline {

void WhyQuestion::ask(ObjectId id, const std::optional<ClientVerdict>& verdict, CullingSession* session) {
  id_ = id;
  verdict_ = verdict;
  answer_.reset();
  sent_ = session != nullptr && session->send_why(++nonce_, 0, id);
}

void WhyQuestion::take_answer(CullingSession& session) {
  for (WhyAnswer& answer : session.take_why_answers()) {
    // Another one may have been asked about meanwhile.
    if (id_ && answer.nonce == nonce_) answer_ = std::move(answer);
  }
}

std::vector<std::string> WhyQuestion::lines() const {
  std::vector<std::string> lines;
  if (!id_) return lines;
  const auto add = [&lines](const WhyLine& line) {
    std::string text = line.key;
    text.resize(std::max<std::size_t>(text.size() + 1, 10), ' ');
    lines.push_back(text + line.text);
  };
  add({"object", called(*id_, scene_)});
  if (verdict_) add(line_of(*verdict_));
  if (answer_) {
    for (const WhyLine& line : lines_of(*answer_, scene_)) add(line);
  } else {
    add({"state", sent_ ? "asked, no answer yet" : "there is no session to ask"});
  }
  if (lines.size() > k_most_lines) {
    const std::size_t left_out = lines.size() - k_most_lines + 1;
    lines.resize(k_most_lines - 1);
    lines.push_back("... and " + std::to_string(left_out) + " more");
  }
  return lines;
}

}  // namespace sightline
