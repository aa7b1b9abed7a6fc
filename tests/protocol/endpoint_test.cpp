#include "protocol/endpoint.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "protocol/clean_text.hpp"

namespace sightline {
namespace {

bool is_accepted(const std::string& text, LinkEnd end) {
  try {
    EXPECT_EQ(parse_endpoint(text, end).text, text);
    return true;
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("'" + clean_text(text) + "'"));
    return false;
  }
}

TEST(Endpoint, AcceptsAddressesForBothEnds) {
  for (const char* text :
       {"tcp://127.0.0.1:5555", "tcp://localhost:1", "tcp://control_view:65535", "tcp://[::1]:80",
        "tcp://[fe80::1]:5555", "ipc:///tmp/sightline", "ipc://relative"}) {
    EXPECT_TRUE(is_accepted(text, LinkEnd::client)) << text;
    EXPECT_TRUE(is_accepted(text, LinkEnd::server)) << text;
  }
}

TEST(Endpoint, AcceptsWildcardsForAServerOnly) {
  for (const char* text :
       {"tcp://*:5555", "tcp://127.0.0.1:*", "tcp://*:*", "tcp://127.0.0.1:0", "ipc://*"}) {
    EXPECT_FALSE(is_accepted(text, LinkEnd::client)) << text;
    EXPECT_TRUE(is_accepted(text, LinkEnd::server)) << text;
  }
}

TEST(Endpoint, RefusesEverythingElse) {
  for (const std::string& text : {std::string(),
                                  std::string("tcp"),
                                  std::string("tcp://"),
                                  std::string("tcp://host"),
                                  std::string("tcp://:5555"),
                                  std::string("tcp://host:"),
                                  std::string("tcp://host:65536"),
                                  std::string("tcp://host:-1"),
                                  std::string("tcp://host:5x"),
                                  std::string("tcp://host: 5"),
                                  std::string("tcp://::1:5555"),
                                  std::string("tcp://[]:5555"),
                                  std::string("tcp://[zz]:5555"),
                                  std::string("tcp://a;b:5555"),
                                  std::string("tcp://a b:5555"),
                                  std::string("tcp://a/b:5555"),
                                  std::string("udp://127.0.0.1:5555"),
                                  std::string("inproc://name"),
                                  std::string("pgm://eth0;1.2.3.4:5"),
                                  std::string("TCP://127.0.0.1:5555"),
                                  std::string("http://127.0.0.1:80"),
                                  std::string("ipc://"),
                                  std::string("ipc://@"),
                                  std::string("ipc://@abstract"),
                                  "ipc://" + std::string(108, 'x'),
                                  std::string("ipc://a\0b", 9)}) {
    EXPECT_FALSE(is_accepted(text, LinkEnd::client)) << text;
    EXPECT_FALSE(is_accepted(text, LinkEnd::server)) << text;
  }
}

TEST(Endpoint, AsksForIpv6OnlyForItsLiterals) {
  EXPECT_TRUE(parse_endpoint("tcp://[::1]:1", LinkEnd::client).needs_ipv6());
  EXPECT_FALSE(parse_endpoint("tcp://localhost:1", LinkEnd::client).needs_ipv6());
  EXPECT_FALSE(parse_endpoint("ipc://[x]", LinkEnd::client).needs_ipv6());
}

}  // namespace
}  // namespace sightline
