#include "control_view/scene_builder.hpp"

#include <exception>
#include <span>
#include <utility>

#include <malloc.h>

#include "common/error.hpp"
#include "control_view/decode_scene.hpp"
#include "protocol/scene_chunks.hpp"
#include "protocol/scene_data.hpp"

namespace sightline {
namespace {

std::vector<std::uint32_t> wrong_chunks(const SceneOffer& offer, std::span<const std::uint8_t> bytes) {
  std::vector<std::uint32_t> wrong;
  for (std::uint32_t i = 0; i < offer.chunk_digests.size(); ++i) {
    if (digest_of(chunk_of(bytes, i)) != offer.chunk_digests[i]) wrong.push_back(i);
  }
  return wrong;
}

}  // namespace

SceneBuilder::SceneBuilder(MakeEngine make_engine)
    : make_engine_(std::move(make_engine)), thread_([this] { run(); }) {}

SceneBuilder::~SceneBuilder() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
    jobs_.clear();
  }
  changed_.notify_one();
  thread_.join();
}

void SceneBuilder::build(const SceneOffer& offer, SceneBytes bytes) {
  {
    const std::lock_guard lock(mutex_);
    jobs_.push_back({offer, std::move(bytes)});
  }
  changed_.notify_one();
}

std::optional<BuiltScene> SceneBuilder::take() {
  const std::lock_guard lock(mutex_);
  if (done_.empty()) return {};
  BuiltScene built = std::move(done_.front());
  done_.pop_front();
  return built;
}

void SceneBuilder::run() {
  for (std::unique_lock lock(mutex_);;) {
    changed_.wait(lock, [this] { return ends_ || !jobs_.empty(); });
    if (ends_) return;
    Job job = std::move(jobs_.front());
    jobs_.pop_front();
    lock.unlock();
    BuiltScene built = build(std::move(job));
    lock.lock();
    done_.push_back(std::move(built));
  }
}

BuiltScene SceneBuilder::build(Job job) const {
  BuiltScene built;
  built.digest = job.offer.scene_digest;
  const std::span<const std::uint8_t> bytes(job.bytes.bytes.get(), job.bytes.byte_count);
  try {
    if (auto wrong = wrong_chunks(job.offer, bytes); !wrong.empty()) {
      built.result = std::move(wrong);
      built.bytes = std::move(job.bytes);
      return built;
    }
    auto decoded = decode_scene_data(bytes);
    if (const auto* error = std::get_if<DecodeError>(&decoded)) {
      built.result = error->reason;
      return built;
    }
    SceneData data = std::get<SceneData>(std::move(decoded));
    job.bytes = {};
    if (std::string excess = excess_of(data); !excess.empty()) {
      built.result = std::move(excess);
      return built;
    }
    if (data.object_count() != job.offer.object_count) {
      built.result = "object_count: the offer says " + std::to_string(job.offer.object_count) +
                     ", the scene has " + std::to_string(data.object_count());
      return built;
    }
    if (data.triangle_count() != job.offer.triangle_count) {
      built.result = "triangle_count: the offer says " + std::to_string(job.offer.triangle_count) +
                     ", the scene has " + std::to_string(data.triangle_count());
      return built;
    }
    auto served = std::make_shared<ServedScene>();
    served->identity = {job.offer.scene_digest, job.offer.object_count};
    served->roles = SceneRoles(data.objects);
    served->byte_count = job.offer.byte_count;
    served->engine = make_engine_(scene_of(std::move(data), "uploaded scene"));
    built.result = std::move(served);
  } catch (const std::exception& error) {  // of this scene alone: bad values, or more memory than there is
    built.result = std::string(error.what());
  }
  malloc_trim(0);
  return built;
}

}  // namespace sightline
