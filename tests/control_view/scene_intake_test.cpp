#include "control_view/scene_intake.hpp"

#include <array>
#include <chrono>
#include <cstring>
#include <functional>
#include <future>
#include <map>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "protocol/roaring_format.hpp"
#include "tests/control_view/fake_engine.hpp"
#include "tests/control_view/scene_data_of.hpp"

namespace sightline::test {
namespace {

const PeerId k_honest = "honest", k_other = "other", k_liar = "liar";

/// Two triangles and many vertices that nobody uses, so that it has some chunks: `seed` tells scenes apart.
SceneData bulky_scene(std::uint64_t seed, std::size_t bytes = 5 * k_scene_chunk_bytes / 2) {
  SceneData scene;
  std::mt19937_64 random(seed);
  for (std::size_t i = 0; i < bytes / sizeof(glm::vec3); ++i)
    scene.positions.emplace_back(random() % 100, random() % 100, random() % 100);
  scene.indices = {0, 1, 2, 2, 3, 0};
  scene.primitives = {{0, 6, 0}};
  scene.meshes = {{0, 1}};
  scene.materials.resize(1);
  scene.objects.resize(2);
  scene.spare_objects = 3;
  return scene;
}

/// An intake with a clock of its own, which turns only when told.
struct Intake {
  explicit Intake(const IntakeLimits& limits = {})
      : intake(scenes, limits, [this](const Scene& scene) { return make(scene); }) {}

  std::unique_ptr<VisibilityEngine> make(const Scene& scene) {
    if (make_engine) make_engine(scene);
    return std::make_unique<FakeEngine>();
  }

  std::vector<SceneStatus> told(const PeerId& peer) {
    for (SceneIntake::Notice& notice : intake.take_notices()) inbox[notice.peer].push_back(notice.status);
    return std::exchange(inbox[peer], {});
  }
  SceneStatus last_told(const PeerId& peer) {
    const auto all = told(peer);
    if (all.empty()) ADD_FAILURE() << "nothing was told";
    return all.empty() ? SceneStatus{} : all.back();
  }
  /// Lets the builder finish, in bounded time.
  void settle() {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    do {
      intake.step(now_s);
      std::this_thread::yield();
    } while (intake.is_busy() && std::chrono::steady_clock::now() < end);
    EXPECT_FALSE(intake.is_busy());
  }
  void send(const PeerId& peer, const Parcel& parcel) {
    intake.offer(peer, parcel.offer, now_s);
    for (std::uint32_t i = 0; i < parcel.chunk_count(); ++i) intake.take(peer, parcel.chunk(i), now_s);
    settle();
  }

  double now_s = 1000.0;
  SceneStore scenes;
  std::function<void(const Scene&)> make_engine;
  std::map<PeerId, std::vector<SceneStatus>> inbox;
  SceneIntake intake;
};

std::vector<std::uint32_t> chunks_held(const SceneStatus& status) {
  const RoaringBitmap bitmap =
      RoaringBitmap::readSafe(reinterpret_cast<const char*>(status.held.data()), status.held.size());
  return {bitmap.begin(), bitmap.end()};
}

TEST(SceneIntake, MakesASceneOfItsChunksInAnyOrder) {
  Intake daemon;
  const Parcel parcel(bulky_scene(1));
  ASSERT_EQ(parcel.chunk_count(), 3u);
  std::uint64_t triangles = 0;
  daemon.make_engine = [&](const Scene& scene) { triangles = scene.triangle_count(); };
  daemon.intake.offer(k_honest, parcel.offer, daemon.now_s);
  EXPECT_EQ(daemon.last_told(k_honest).state, SceneState::uploading);
  for (const std::uint32_t i : {2u, 0u, 1u}) daemon.intake.take(k_honest, parcel.chunk(i), daemon.now_s);
  EXPECT_EQ(daemon.last_told(k_honest).state, SceneState::building);
  daemon.settle();
  EXPECT_EQ(daemon.last_told(k_honest).state, SceneState::ready);
  EXPECT_EQ(triangles, 4u);
  const ServedScenePtr scene = daemon.scenes.find(parcel.offer.scene_digest);
  ASSERT_NE(scene, nullptr);
  EXPECT_EQ(scene->identity.object_count, 5u);
}

TEST(SceneIntake, GoesOnWhereItWasAfterAReconnect) {
  Intake daemon;
  const Parcel parcel(bulky_scene(2));
  daemon.intake.offer(k_honest, parcel.offer, daemon.now_s);
  daemon.intake.take(k_honest, parcel.chunk(1), daemon.now_s);
  daemon.intake.offer(k_other, parcel.offer, daemon.now_s);  // the same client, on another connection
  const SceneStatus status = daemon.last_told(k_other);
  EXPECT_EQ(chunks_held(status), std::vector<std::uint32_t>{1});
  EXPECT_EQ(status.chunks_held, 1u);
  EXPECT_EQ(status.chunk_count, 3u);
  for (const std::uint32_t i : {0u, 2u}) daemon.intake.take(k_other, parcel.chunk(i), daemon.now_s);
  daemon.settle();
  EXPECT_EQ(daemon.last_told(k_other).state, SceneState::ready);
}

TEST(SceneIntake, TellsASecondClientAtOnceThatTheSceneIsThere) {
  Intake daemon;
  const Parcel parcel(bulky_scene(3));
  daemon.send(k_honest, parcel);
  daemon.intake.offer(k_other, parcel.offer, daemon.now_s);
  EXPECT_EQ(daemon.last_told(k_other).state, SceneState::ready);
}

TEST(SceneIntake, KeepsWhatOthersSentWhenOnePeerLies) {
  Intake daemon;
  const Parcel parcel(bulky_scene(4));
  daemon.intake.offer(k_honest, parcel.offer, daemon.now_s);
  daemon.intake.offer(k_liar, parcel.offer, daemon.now_s);
  SceneChunk forged = parcel.chunk(1);
  forged.bytes[100] ^= 1;
  daemon.intake.take(k_liar, forged, daemon.now_s);
  for (std::uint32_t i = 0; i < 3; ++i) daemon.intake.take(k_honest, parcel.chunk(i), daemon.now_s);
  daemon.settle();
  EXPECT_EQ(daemon.last_told(k_liar).state, SceneState::failed);
  const SceneStatus status = daemon.last_told(k_honest);
  EXPECT_EQ(status.state, SceneState::uploading);
  EXPECT_EQ(chunks_held(status), (std::vector<std::uint32_t>{0, 2}));
  EXPECT_EQ(daemon.scenes.find(parcel.offer.scene_digest), nullptr);

  daemon.intake.take(k_liar, forged, daemon.now_s);  // is not listened to any more
  daemon.intake.take(k_honest, parcel.chunk(1), daemon.now_s);
  daemon.settle();
  EXPECT_EQ(daemon.last_told(k_honest).state, SceneState::ready);
}

/// A chunk of the right length that is not the parcel's.
SceneChunk forged_chunk(const Parcel& parcel, std::uint32_t index, std::uint8_t salt = 1) {
  SceneChunk forged = parcel.chunk(index);
  forged.bytes[100] ^= salt;
  return forged;
}

TEST(SceneIntake, TellsALiarBeforeTheUploadIsWhole) {
  Intake daemon;
  const Parcel parcel(bulky_scene(21));
  daemon.intake.offer(k_honest, parcel.offer, daemon.now_s);
  daemon.intake.take(k_honest, parcel.chunk(0), daemon.now_s);
  daemon.intake.take(k_liar, forged_chunk(parcel, 1), daemon.now_s);
  daemon.settle();
  const SceneStatus told = daemon.last_told(k_liar);
  EXPECT_EQ(told.state, SceneState::failed);
  EXPECT_NE(told.text.find("chunk 1"), std::string::npos) << told.text;
  const SceneStatus status = daemon.last_told(k_honest);
  EXPECT_EQ(status.state, SceneState::uploading);
  EXPECT_EQ(chunks_held(status), std::vector<std::uint32_t>{0});

  for (const std::uint32_t i : {1u, 2u}) daemon.intake.take(k_honest, parcel.chunk(i), daemon.now_s);
  daemon.settle();
  EXPECT_EQ(daemon.last_told(k_honest).state, SceneState::ready);
  EXPECT_TRUE(daemon.told(k_liar).empty());
}

TEST(SceneIntake, ChecksWhatWasSentBeforeWhenASecondPeerComes) {
  Intake daemon;
  const Parcel parcel(bulky_scene(22));
  daemon.intake.offer(k_liar, parcel.offer, daemon.now_s);
  daemon.intake.take(k_liar, forged_chunk(parcel, 0), daemon.now_s);
  daemon.intake.take(k_liar, parcel.chunk(1), daemon.now_s);  // a liar's right ones are right
  daemon.settle();
  EXPECT_EQ(daemon.last_told(k_liar).state, SceneState::uploading);  // alone it is checked when it is done
  daemon.intake.offer(k_honest, parcel.offer, daemon.now_s);
  daemon.settle();
  EXPECT_EQ(daemon.last_told(k_liar).state, SceneState::failed);
  EXPECT_EQ(chunks_held(daemon.last_told(k_honest)), std::vector<std::uint32_t>{1});
  for (const std::uint32_t i : {0u, 2u}) daemon.intake.take(k_honest, parcel.chunk(i), daemon.now_s);
  daemon.settle();
  EXPECT_EQ(daemon.last_told(k_honest).state, SceneState::ready);
}

TEST(SceneIntake, ChecksALonePeerWhenItIsDone) {
  Intake daemon;
  const Parcel parcel(bulky_scene(23));
  daemon.intake.offer(k_liar, parcel.offer, daemon.now_s);
  daemon.intake.take(k_liar, forged_chunk(parcel, 0), daemon.now_s);
  for (const std::uint32_t i : {1u, 2u}) daemon.intake.take(k_liar, parcel.chunk(i), daemon.now_s);
  daemon.settle();
  EXPECT_EQ(daemon.last_told(k_liar).state, SceneState::failed);
  EXPECT_EQ(daemon.scenes.size(), 0u);
  // The same client on another connection, in its right mind.
  daemon.intake.offer(k_honest, parcel.offer, daemon.now_s);
  EXPECT_EQ(chunks_held(daemon.last_told(k_honest)), (std::vector<std::uint32_t>{1, 2}));
  daemon.intake.take(k_honest, parcel.chunk(0), daemon.now_s);
  daemon.settle();
  EXPECT_EQ(daemon.last_told(k_honest).state, SceneState::ready);
}

TEST(SceneIntake, TakesOnlyWhatIsRightFromMorePeersThanItRemembers) {
  Intake daemon;
  const Parcel parcel(bulky_scene(25));
  for (int ghost = 0; ghost < 64; ++ghost)
    daemon.intake.offer("ghost " + std::to_string(ghost), parcel.offer, daemon.now_s);
  for (std::uint32_t i = 0; i < parcel.chunk_count(); ++i) {
    daemon.intake.take(k_liar, forged_chunk(parcel, i), daemon.now_s);
    EXPECT_EQ(daemon.last_told(k_liar).state, SceneState::failed);
    daemon.intake.take(k_honest, parcel.chunk(i), daemon.now_s);
  }
  daemon.settle();
  daemon.intake.offer(k_honest, parcel.offer, daemon.now_s);
  EXPECT_EQ(daemon.last_told(k_honest).state, SceneState::ready);
}

TEST(SceneIntake, GivesThePlacesOfEmptyOffersToOthers) {
  IntakeLimits limits;
  limits.scenes = 2;
  Intake daemon(limits);
  const Parcel one(bulky_scene(26)), two(bulky_scene(27)), wanted(bulky_scene(28)), last(bulky_scene(29));
  for (const Parcel* squat : {&one, &two}) daemon.intake.offer(k_liar, squat->offer, daemon.now_s);
  daemon.intake.take(k_liar, two.chunk(0), daemon.now_s);
  daemon.intake.offer(k_honest, wanted.offer, daemon.now_s);
  EXPECT_EQ(daemon.last_told(k_honest).state, SceneState::full);  // their chunks may be on their way
  daemon.now_s += SceneIntake::k_patience_s + 0.1;
  daemon.send(k_honest, wanted);
  EXPECT_EQ(daemon.last_told(k_honest).state, SceneState::ready);
  daemon.intake.offer(k_other, last.offer, daemon.now_s);
  EXPECT_EQ(daemon.last_told(k_other).state, SceneState::full);  // one has a chunk, one is ready
}

// An honest client does what the statuses say; others forge chunks, two each. However they race, the scene
// that comes about is the honest one's and nobody honest is blamed.
TEST(SceneIntake, EndsWithTheRightSceneHoweverLiarsRace) {
  const Parcel parcel(bulky_scene(24, 11 * k_scene_chunk_bytes / 2));
  const auto name = [](std::size_t lie) { return "liar " + std::to_string(lie / 2); };
  std::size_t caught = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    std::mt19937_64 random(seed);
    Intake daemon;
    std::uint64_t triangles = 0;
    daemon.make_engine = [&](const Scene& scene) { triangles = scene.triangle_count(); };
    std::size_t lies = 0;
    for (int round = 0; round < 100 && triangles == 0; ++round) {
      daemon.intake.offer(k_honest, parcel.offer, daemon.now_s);
      const auto held = chunks_held(daemon.last_told(k_honest));
      for (std::uint32_t i = 0; i < parcel.chunk_count(); ++i) {
        if (random() % 2 == 0 && lies < 60) {
          const auto index = static_cast<std::uint32_t>(random() % parcel.chunk_count());
          const auto salt = static_cast<std::uint8_t>(1 + random() % 255);
          daemon.intake.take(name(lies++), forged_chunk(parcel, index, salt), daemon.now_s);
        }
        if (std::ranges::find(held, i) == held.end())
          daemon.intake.take(k_honest, parcel.chunk(i), daemon.now_s);
        if (random() % 4 == 0) daemon.intake.step(daemon.now_s);
      }
      daemon.settle();
    }
    EXPECT_EQ(triangles, 4u) << "seed " << seed;
    for (const SceneStatus& status : daemon.told(k_honest)) EXPECT_NE(status.state, SceneState::failed);
    for (std::size_t lie = 0; lie < lies; lie += 2) {
      for (const SceneStatus& status : daemon.told(name(lie)))
        caught += status.text.find("digest") != std::string::npos;
    }
  }
  EXPECT_GT(caught, 30u);
}

TEST(SceneIntake, TellsEveryOneOfSeveralLiars) {
  Intake daemon;
  const Parcel parcel(bulky_scene(25));
  daemon.intake.offer(k_honest, parcel.offer, daemon.now_s);
  daemon.intake.take(k_liar, forged_chunk(parcel, 0), daemon.now_s);
  daemon.intake.take(k_other, forged_chunk(parcel, 2, 3), daemon.now_s);
  daemon.intake.take(k_honest, parcel.chunk(1), daemon.now_s);
  daemon.settle();
  EXPECT_EQ(daemon.last_told(k_liar).state, SceneState::failed);
  EXPECT_EQ(daemon.last_told(k_other).state, SceneState::failed);
  const SceneStatus status = daemon.last_told(k_honest);
  EXPECT_EQ(status.state, SceneState::uploading);
  EXPECT_EQ(chunks_held(status), std::vector<std::uint32_t>{1});
}

TEST(SceneIntake, FindsALiarWhileAnotherScenesEngineIsMade) {
  Intake daemon;
  std::promise<void> may_end;
  daemon.make_engine = [ended = may_end.get_future().share()](const Scene&) { ended.wait(); };
  const Parcel slow(bulky_scene(26)), other(bulky_scene(27));
  daemon.intake.offer(k_other, slow.offer, daemon.now_s);
  for (std::uint32_t i = 0; i < 3; ++i) daemon.intake.take(k_other, slow.chunk(i), daemon.now_s);
  daemon.intake.offer(k_honest, other.offer, daemon.now_s);
  daemon.intake.take(k_liar, forged_chunk(other, 0), daemon.now_s);
  std::vector<SceneStatus> told;
  for (const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
       told.empty() && std::chrono::steady_clock::now() < end; std::this_thread::yield()) {
    daemon.intake.step(daemon.now_s);
    told = daemon.told(k_liar);
  }
  may_end.set_value();
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(told.back().state, SceneState::failed);
  daemon.settle();
  EXPECT_EQ(daemon.last_told(k_other).state, SceneState::ready);
}

TEST(SceneIntake, RefusesAnOfferWhoseDigestIsNotItsOwn) {
  Intake daemon;
  SceneOffer offer = Parcel(bulky_scene(5)).offer;
  offer.object_count = 4;
  daemon.intake.offer(k_honest, offer, daemon.now_s);
  const SceneStatus status = daemon.last_told(k_honest);
  EXPECT_EQ(status.state, SceneState::failed);
  EXPECT_NE(status.text.find("scene_digest"), std::string::npos) << status.text;
}

TEST(SceneIntake, RefusesWhatIsAboveItsLimitsAndSaysWhich) {
  const Parcel parcel(bulky_scene(6));
  const auto refusal_under = [&](const std::function<void(IntakeLimits&)>& tighten) {
    IntakeLimits limits;
    tighten(limits);
    Intake daemon(limits);
    daemon.intake.offer(k_honest, parcel.offer, daemon.now_s);
    const SceneStatus status = daemon.last_told(k_honest);
    EXPECT_EQ(status.state, SceneState::failed);
    return status.text;
  };
  EXPECT_NE(refusal_under([](auto& l) { l.scene_bytes = 1000; }).find("bytes"), std::string::npos);
  EXPECT_NE(refusal_under([](auto& l) { l.objects = 4; }).find("5 objects"), std::string::npos);
  EXPECT_NE(refusal_under([](auto& l) { l.triangles = 3; }).find("4 triangles"), std::string::npos);
  EXPECT_NE(refusal_under([](auto& l) { l.all_bytes = 1000; }).find("at most 1000"), std::string::npos);
}

TEST(SceneIntake, MakesRoomByForgettingScenesThatNobodyUses) {
  IntakeLimits limits;
  limits.scenes = 2;
  Intake daemon(limits);
  const Parcel first(bulky_scene(7)), second(bulky_scene(8)), third(bulky_scene(9));
  daemon.send(k_honest, first);
  daemon.scenes.find(first.offer.scene_digest)->sessions = 1;
  daemon.send(k_honest, second);
  daemon.told(k_honest);
  daemon.intake.offer(k_honest, third.offer, daemon.now_s);
  const SceneStatus status = daemon.last_told(k_honest);
  EXPECT_EQ(status.state, SceneState::full);  // a client of `second` may come back
  EXPECT_NE(status.text.find("at most 2 scenes"), std::string::npos) << status.text;
  daemon.now_s += SceneStore::k_idle_s + 1.0;
  daemon.send(k_honest, third);
  EXPECT_EQ(daemon.last_told(k_honest).state, SceneState::ready);
  EXPECT_NE(daemon.scenes.find(first.offer.scene_digest), nullptr);
  EXPECT_EQ(daemon.scenes.find(second.offer.scene_digest), nullptr);
}

TEST(SceneIntake, ForgetsAnUploadThatNobodyGoesOnWith) {
  Intake daemon;
  const Parcel parcel(bulky_scene(10));
  daemon.intake.offer(k_honest, parcel.offer, daemon.now_s);
  daemon.intake.take(k_honest, parcel.chunk(0), daemon.now_s);
  daemon.now_s += SceneIntake::k_idle_s + 1.0;
  daemon.intake.step(daemon.now_s);
  daemon.told(k_honest);
  daemon.intake.take(k_honest, parcel.chunk(1), daemon.now_s);
  const SceneStatus status = daemon.last_told(k_honest);
  EXPECT_EQ(status.state, SceneState::failed);
  EXPECT_NE(status.text.find("offer first"), std::string::npos);
}

TEST(SceneIntake, SaysWhyNoSceneCanBeMade) {
  Intake daemon;
  SceneData out_of_range = bulky_scene(11);
  out_of_range.indices[3] = 1u << 30;
  daemon.send(k_honest, Parcel(out_of_range));
  SceneStatus status = daemon.last_told(k_honest);
  EXPECT_EQ(status.state, SceneState::failed);
  EXPECT_NE(status.text.find("out of range"), std::string::npos) << status.text;

  SceneData no_number = bulky_scene(12);
  no_number.objects[1].world_from_object[3].y = std::nan("");
  daemon.send(k_honest, Parcel(no_number));
  EXPECT_EQ(daemon.last_told(k_honest).state, SceneState::failed);

  Parcel noise(bulky_scene(13));
  for (std::size_t i = 0; i < 64; ++i) noise.bytes[i] = static_cast<std::uint8_t>(i * 37);
  noise.offer = offer_of(noise.bytes, 5, 4);
  daemon.send(k_honest, noise);
  status = daemon.last_told(k_honest);
  EXPECT_EQ(status.state, SceneState::failed);
  EXPECT_NE(status.text.find("SLSD"), std::string::npos) << status.text;

  Parcel lies(bulky_scene(14));
  lies.offer = offer_of(lies.bytes, 6, 4);
  daemon.send(k_honest, lies);
  EXPECT_NE(daemon.last_told(k_honest).text.find("object_count"), std::string::npos);

  daemon.make_engine = [](const Scene&) { throw MachineError("no memory is left"); };
  daemon.send(k_honest, Parcel(bulky_scene(15)));
  EXPECT_NE(daemon.last_told(k_honest).text.find("no memory"), std::string::npos);
  EXPECT_EQ(daemon.scenes.size(), 0u);
}

TEST(SceneIntake, RefusesRunsThatNameFarMoreThanThereIs) {
  Intake daemon;
  SceneData meshes = bulky_scene(18);
  meshes.meshes.resize(100'000, SceneData::Mesh{0, 1});
  daemon.send(k_honest, Parcel(meshes));
  EXPECT_NE(daemon.last_told(k_honest).text.find("meshes"), std::string::npos);
  SceneData primitives = bulky_scene(19);
  primitives.primitives.resize(100'000, SceneData::Primitive{0, 6, 0});
  daemon.send(k_honest, Parcel(primitives));
  EXPECT_NE(daemon.last_told(k_honest).text.find("primitives"), std::string::npos);
}

TEST(SceneIntake, IsNotKeptFullByOffersAlone) {
  Intake daemon;
  const Parcel parcel(bulky_scene(20));
  daemon.intake.offer(k_honest, parcel.offer, daemon.now_s);
  daemon.intake.take(k_honest, parcel.chunk(0), daemon.now_s);
  daemon.now_s += 0.9 * SceneIntake::k_idle_s;
  daemon.intake.offer(k_other, parcel.offer, daemon.now_s);
  daemon.intake.take(k_other, parcel.chunk(0), daemon.now_s);  // held already
  daemon.settle();
  daemon.now_s += 0.2 * SceneIntake::k_idle_s;
  daemon.intake.step(daemon.now_s);
  daemon.intake.offer(k_honest, parcel.offer, daemon.now_s);
  EXPECT_EQ(daemon.last_told(k_honest).chunks_held, 0u);
}

TEST(SceneIntake, DropsChunksOfAnotherLengthOrNumber) {
  Intake daemon;
  const Parcel parcel(bulky_scene(16));
  daemon.intake.offer(k_honest, parcel.offer, daemon.now_s);
  SceneChunk chunk = parcel.chunk(0);
  chunk.bytes.pop_back();
  daemon.intake.take(k_honest, chunk, daemon.now_s);
  EXPECT_EQ(daemon.last_told(k_honest).state, SceneState::failed);
  chunk = parcel.chunk(2);
  chunk.index = 3;
  daemon.intake.take(k_honest, chunk, daemon.now_s);
  EXPECT_EQ(daemon.last_told(k_honest).state, SceneState::failed);
  daemon.intake.offer(k_honest, parcel.offer, daemon.now_s);
  EXPECT_EQ(daemon.last_told(k_honest).chunks_held, 0u);
}

TEST(SceneIntake, SurvivesAnyBytesInPlaceOfAScene) {
  Intake daemon;
  std::mt19937_64 random(99);
  const std::vector<std::uint8_t> good = encode_scene_data(bulky_scene(17, 4000));
  for (int round = 0; round < 300; ++round) {
    Parcel parcel(bulky_scene(17, 4000));
    for (int change = static_cast<int>(random() % 6); change >= 0; --change)
      parcel.bytes[random() % std::min<std::size_t>(parcel.bytes.size(), 900)] =
          static_cast<std::uint8_t>(random());
    if (random() % 4 == 0) parcel.bytes.resize(4 + random() % (good.size() - 4));
    parcel.offer = offer_of(parcel.bytes, 5, 4);
    daemon.send(k_honest, parcel);
    const SceneState state = daemon.last_told(k_honest).state;
    EXPECT_TRUE(state == SceneState::ready || state == SceneState::failed);
    daemon.now_s += 61.0;  // what was taken makes room
  }
}

}  // namespace
}  // namespace sightline::test
