#include "protocol/message_checks.hpp"

#include <functional>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "protocol/codec.hpp"
#include "sample_messages.hpp"

namespace sightline {
namespace {

using testing::HasSubstr;

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
constexpr double k_infinity = std::numeric_limits<double>::infinity();

/// Why the frame of a message is refused; "accepted" when it is not.
std::string refusal_of(const Message& message) {
  const auto result = decode(encode(message));
  const auto* error = std::get_if<DecodeError>(&result);
  return error == nullptr ? "accepted" : error->reason;
}

template <typename Body>
Body golden(const char* name) {
  for (const NamedMessage& named : golden_messages()) {
    if (named.name == name) return std::get<Body>(named.message);
  }
  ADD_FAILURE() << name;
  return {};
}

template <typename Body>
std::string refusal_after(const char* name, const std::function<void(Body&)>& change) {
  Body body = golden<Body>(name);
  EXPECT_EQ(refusal_of(body), "accepted");
  change(body);
  return refusal_of(body);
}

std::string request_refusal(const std::function<void(ViewRequest&)>& change) {
  return refusal_after<ViewRequest>("view_request", change);
}

TEST(ViewRequestChecks, RefuseWrongNumbersOfEyes) {
  EXPECT_THAT(request_refusal([](ViewRequest& r) { r.eyes.clear(); }), HasSubstr("eyes: 0"));
  EXPECT_THAT(request_refusal([](ViewRequest& r) { r.eyes.resize(k_max_eyes, r.eyes[0]); }), "accepted");
  EXPECT_THAT(request_refusal([](ViewRequest& r) { r.eyes.resize(k_max_eyes + 1, r.eyes[0]); }),
              HasSubstr("eyes: 9"));
}

TEST(ViewRequestChecks, RefuseNumbersThatAreNotFinite) {
  for (const double bad : {k_nan, k_infinity, -k_infinity, 1e300}) {
    EXPECT_THAT(request_refusal([=](ViewRequest& r) { r.for_time_s = bad; }), HasSubstr("for_time_s"));
    EXPECT_THAT(request_refusal([=](ViewRequest& r) { r.rotation_error_rad = bad; }),
                HasSubstr("rotation_error"));
    EXPECT_THAT(request_refusal([=](ViewRequest& r) { r.position_error_m = bad; }),
                HasSubstr("position_error"));
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 4; ++row) {
        EXPECT_THAT(request_refusal([=](ViewRequest& r) { r.eyes[0].camera_from_world[column][row] = bad; }),
                    HasSubstr("camera_from_world"));
        EXPECT_THAT(request_refusal([=](ViewRequest& r) { r.eyes[0].clip_from_camera[column][row] = bad; }),
                    HasSubstr("clip_from_camera"));
      }
      EXPECT_THAT(request_refusal([=](ViewRequest& r) { r.moves[0].world_from_object[column][1] = bad; }),
                  HasSubstr("moves"));
    }
  }
}

TEST(ViewRequestChecks, RefuseNegativeErrors) {
  EXPECT_THAT(request_refusal([](ViewRequest& r) { r.rotation_error_rad = -1e-9; }),
              HasSubstr("rotation_error"));
  EXPECT_THAT(request_refusal([](ViewRequest& r) { r.position_error_m = -1e-9; }),
              HasSubstr("position_error"));
}

TEST(ViewRequestChecks, RefuseACameraThatIsNotRigid) {
  const auto refusal = [](const std::function<void(glm::dmat4&)>& change) {
    return request_refusal([&](ViewRequest& r) { change(r.eyes[0].camera_from_world); });
  };
  const auto not_rigid = HasSubstr("not a rotation and a translation");
  EXPECT_THAT(refusal([](glm::dmat4& m) { m[0][0] = 1.001; }), not_rigid);  // scaled
  EXPECT_THAT(refusal([](glm::dmat4& m) { m[1][0] = 0.001; }), not_rigid);  // sheared
  EXPECT_THAT(refusal([](glm::dmat4& m) { m[0][0] = -1.0; }), not_rigid);   // mirrored
  EXPECT_THAT(refusal([](glm::dmat4& m) { m[0][3] = 1e-9; }), not_rigid);   // projective
  EXPECT_THAT(refusal([](glm::dmat4& m) { m[3][3] = 2.0; }), not_rigid);
  EXPECT_THAT(refusal([](glm::dmat4& m) { m = glm::dmat4(0.0); }), not_rigid);
  EXPECT_THAT(refusal([](glm::dmat4& m) { m[0][0] = 1.00001; }), "accepted");  // rounding of 32-bit floats
}

TEST(ViewRequestChecks, RefuseAProjectionWithoutInverse) {
  const auto refusal = [](const std::function<void(glm::dmat4&)>& change) {
    return request_refusal([&](ViewRequest& r) { change(r.eyes[0].clip_from_camera); });
  };
  EXPECT_THAT(refusal([](glm::dmat4& m) { m = glm::dmat4(0.0); }), HasSubstr("no inverse"));
  EXPECT_THAT(refusal([](glm::dmat4& m) { m[3][2] = 0.0; }), HasSubstr("no inverse"));
  EXPECT_THAT(refusal([](glm::dmat4& m) { m[1] = m[0]; }), HasSubstr("no inverse"));
  EXPECT_THAT(refusal([](glm::dmat4& m) { m[0] = m[1] + m[2] * 1e-14; }), HasSubstr("no inverse"));
}

TEST(ViewRequestChecks, RefuseImageSizesNobodyDraws) {
  EXPECT_THAT(request_refusal([](ViewRequest& r) {
                r.main_size = {k_max_image_side + 1, 1};
              }),
              HasSubstr("main_size"));
  EXPECT_THAT(request_refusal([](ViewRequest& r) { r.main_size = {1, 0xFFFFFFFF}; }), HasSubstr("main_size"));
  EXPECT_THAT(request_refusal([](ViewRequest& r) { r.main_size = {0, 1}; }), HasSubstr("main_size"));
  EXPECT_THAT(request_refusal([](ViewRequest& r) { r.main_size = {0, 0}; }), "accepted");
  EXPECT_THAT(request_refusal([](ViewRequest& r) {
                r.main_size = {k_max_image_side, k_max_image_side};
              }),
              "accepted");
}

TEST(ViewRequestChecks, RefuseAnObjectThatMovesTwice) {
  const auto refusal = [](std::initializer_list<std::uint32_t> indices) {
    return request_refusal([&](ViewRequest& r) {
      r.moves.clear();
      for (const std::uint32_t index : indices) r.moves.push_back({ObjectId{index}, glm::dmat4x3(1.0)});
    });
  };
  EXPECT_EQ(refusal({3, 2, 1}), "accepted");
  EXPECT_THAT(refusal({1, 1}), HasSubstr("object 1 twice"));
  EXPECT_THAT(refusal({7, 1, 5, 7, 2}), HasSubstr("object 7 twice"));
  EXPECT_THAT(refusal({0xFFFFFFFF}), HasSubstr("id too large"));
}

TEST(ViewRequestChecks, RefuseBoxesThatHoldNothingAndNumbersThatAreNone) {
  const auto refusal = [](const std::function<void(BoxedObject&)>& change) {
    return request_refusal([&](ViewRequest& r) {
      r.boxed = {{ObjectId{2}, {glm::dvec3(0.0), glm::dvec3(1.0)}}, {ObjectId{4}, {}}};
      change(r.boxed[0]);
    });
  };
  const auto bad_box = HasSubstr("boxed: box of object 2");
  for (int axis = 0; axis < 3; ++axis) {
    for (const double bad : {k_nan, -k_infinity, k_infinity, 1e13, -1e13}) {
      EXPECT_THAT(refusal([=](BoxedObject& b) { b.world_bounds.min[axis] = bad; }), bad_box);
      EXPECT_THAT(refusal([=](BoxedObject& b) { b.world_bounds.max[axis] = bad; }), bad_box);
    }
    EXPECT_THAT(refusal([=](BoxedObject& b) { b.world_bounds.min[axis] = 1.0000001; }), bad_box);
    EXPECT_THAT(refusal([=](BoxedObject& b) { b.world_bounds.min[axis] = 1.0; }), "accepted");
  }
  EXPECT_THAT(refusal([](BoxedObject& b) { b.id = ObjectId{4}; }),
              HasSubstr("boxed: object ids not ascending"));
  EXPECT_THAT(refusal([](BoxedObject& b) { b.id = ObjectId{5}; }),
              HasSubstr("boxed: object ids not ascending"));
  EXPECT_THAT(refusal([](BoxedObject& b) { b.id = ObjectId{0xFFFFFFFF}; }), HasSubstr("id too large"));
}

TEST(ViewRequestChecks, RefuseAnObjectThatBothAppearsAndVanishes) {
  const auto refusal = [](std::vector<ObjectPresence> presence) {
    return request_refusal([&](ViewRequest& r) { r.presence = std::move(presence); });
  };
  EXPECT_EQ(refusal({{ObjectId{1}, true}, {ObjectId{2}, false}}), "accepted");
  EXPECT_THAT(refusal({{ObjectId{1}, true}, {ObjectId{1}, false}}), HasSubstr("presence: object ids"));
  EXPECT_THAT(refusal({{ObjectId{2}, true}, {ObjectId{1}, true}}), HasSubstr("presence: object ids"));
  EXPECT_THAT(refusal({{ObjectId{0xFFFFFFFF}, true}}), HasSubstr("presence: object id too large"));
}

TEST(ViewRequestChecks, RefuseSequenceNumberZero) {
  EXPECT_THAT(request_refusal([](ViewRequest& r) { r.request_seq = 0; }), HasSubstr("request_seq"));
}

TEST(WelcomeChecks, RefuseEveryWrongField) {
  const auto refusal = [](const std::function<void(Welcome&)>& change) {
    return refusal_after<Welcome>("welcome", change);
  };
  EXPECT_THAT(refusal([](Welcome& w) { w.session_id = 0; }), HasSubstr("session_id"));
  EXPECT_THAT(refusal([](Welcome& w) { w.object_count = 0xFFFFFFFF; }), HasSubstr("object_count"));
  EXPECT_THAT(refusal([](Welcome& w) { w.control_size = {1'000'000, 1}; }), HasSubstr("control_size"));
  EXPECT_THAT(refusal([](Welcome& w) { w.filter_length = 0; }), HasSubstr("filter_length"));
  for (const double bad : {k_nan, k_infinity, 0.0, -1.0, 1e9}) {
    EXPECT_THAT(refusal([=](Welcome& w) { w.heartbeat_interval_s = bad; }),
                HasSubstr("heartbeat_interval_s"));
  }
  for (const double bad : {k_nan, k_infinity, -1.0}) {
    EXPECT_THAT(refusal([=](Welcome& w) { w.threshold = bad; }), HasSubstr("threshold"));
    EXPECT_THAT(refusal([=](Welcome& w) { w.control_rate_hz = bad; }), HasSubstr("control_rate_hz"));
  }
}

TEST(VisibleSetFrameChecks, RefuseEveryWrongField) {
  const auto refusal = [](const std::function<void(VisibleSetFrame&)>& change) {
    return refusal_after<VisibleSetFrame>("visible_set_delta", change);
  };
  EXPECT_THAT(refusal([](VisibleSetFrame& f) { f.set_seq = 0; }), HasSubstr("set_seq"));
  EXPECT_THAT(refusal([](VisibleSetFrame& f) { f.request_seq = 0; }), HasSubstr("request_seq"));
  EXPECT_THAT(refusal([](VisibleSetFrame& f) { f.base_seq = f.set_seq; }), HasSubstr("base_seq"));
  EXPECT_THAT(refusal([](VisibleSetFrame& f) { f.for_time_s = k_nan; }), HasSubstr("for_time_s"));
  EXPECT_THAT(refusal([](VisibleSetFrame& f) { f.visible_count = 0xFFFFFFFF; }), HasSubstr("visible_count"));
  EXPECT_THAT(refusal([](VisibleSetFrame& f) { f.times.cull_s = -1.0; }), HasSubstr("times"));
  EXPECT_THAT(refusal([](VisibleSetFrame& f) { f.times.encode_s = k_nan; }), HasSubstr("times"));
}

TEST(HeartbeatChecks, RefuseATimeThatIsNone) {
  EXPECT_THAT(refusal_of(Ping{1, k_nan}), HasSubstr("time_s"));
  EXPECT_THAT(refusal_of(Pong{1, k_infinity}), HasSubstr("time_s"));
}

TEST(RefusalChecks, RefuseReasonZero) {
  EXPECT_THAT(refusal_of(Refusal{static_cast<RefusalReason>(0), "", 1, {}}), HasSubstr("reason"));
}

}  // namespace
}  // namespace sightline
