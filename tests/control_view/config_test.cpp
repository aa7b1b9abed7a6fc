#include "control_view/config.hpp"

#include <algorithm>
#include <variant>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "control_view/command_line.hpp"
#include "tests/control_view/scratch_folder.hpp"

namespace sightline {
namespace {

using test::ScratchFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

template <class Action>
std::string input_error_of(Action action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no InputError";
}

std::string error_of_config(const std::string& text) {
  const ScratchFolder folder;
  const auto file = folder.write("daemon.toml", text);
  DaemonOptions options;
  return input_error_of([&] { read_config(file, options); });
}

DaemonOptions serve_options(const std::vector<std::string>& arguments) {
  return std::get<ServeCommand>(parse_command_line(arguments)).options;
}

TEST(Config, SetsEveryField) {
  const ScratchFolder folder;
  const auto file = folder.write("daemon.toml", R"(
bind = "ipc:///tmp/x"
scene = "city.glb"
size = "640x480"
engine = "item_buffer"
counter = "queries"
threads = 3
filter = 4
threshold = 2.5
context = "egl"
refine = false
max_sessions = 3
control_rate = 30
silence_limit = 7.5
keys = "/etc/keys.toml"
log = "warn"
)");
  DaemonOptions options;
  read_config(file, options);
  EXPECT_EQ(options.bind, "ipc:///tmp/x");
  EXPECT_EQ(options.scene, folder.file("city.glb")) << "relative to the file's own folder";
  EXPECT_EQ(options.size, (ImageSize{640, 480}));
  EXPECT_EQ(options.engine.engine, "item_buffer");
  EXPECT_EQ(options.engine.counter, "queries");
  EXPECT_EQ(options.engine.threads, 3u);
  EXPECT_EQ(options.engine.context, "egl");
  EXPECT_EQ(options.filter, 4u);
  EXPECT_EQ(options.threshold, 2.5);
  EXPECT_FALSE(options.refine);
  EXPECT_EQ(options.max_sessions, 3u);
  EXPECT_EQ(options.control_rate_hz, 30.0);
  EXPECT_EQ(options.silence_limit_s, 7.5);
  EXPECT_EQ(options.keys, "/etc/keys.toml");
  EXPECT_EQ(options.log, "warn");
}

TEST(Config, NamesTheFileAndTheKeyOfWhatItRefuses) {
  const std::pair<const char*, const char*> refused[] = {
      {"filtr = 4", "unknown key 'filtr'"},
      {"filter = \"4\"", "filter must be an integer"},
      {"filter = 4.5", "filter must be an integer"},
      {"filter = 0", "filter must be"},
      {"filter = 100000", "filter must be"},
      {"filter = -1", "filter must be"},
      {"threads = -1", "threads must be"},
      {"threads = 1e9", "threads must be an integer"},
      {"threads = 100000", "threads must be"},
      {"threshold = -0.5", "threshold must be"},
      {"threshold = nan", "threshold must be"},
      {"threshold = true", "threshold must be a number"},
      {"size = \"0x0\"", "size must be"},
      {"size = \"1000000x1000000\"", "size must be"},
      {"size = [512, 384]", "size must be a string"},
      {"context = \"directx\"", "context must be"},
      {"refine = \"on\"", "refine must be true or false"},
      {"max_sessions = 0", "max_sessions must be"},
      {"silence_limit = inf", "silence_limit must be"},
      {"log = \"loud\"", "log must be"},
      {"[table]\nx = 1", "unknown key 'table'"},
  };
  for (const auto& [text, expected] : refused) {
    EXPECT_THAT(error_of_config(text),
                AllOf(HasSubstr("daemon.toml"), HasSubstr(expected), Not(HasSubstr("\n"))))
        << text;
  }
}

TEST(Config, NamesTheLineOfASyntaxError) {
  EXPECT_THAT(error_of_config("filter = 4\nsize = = 3\n"),
              AllOf(HasSubstr("daemon.toml:2"), Not(HasSubstr("\n"))));
}

TEST(Config, RefusesAFileThatIsNotThere) {
  DaemonOptions options;
  EXPECT_THAT(input_error_of([&] { read_config("/nowhere/daemon.toml", options); }),
              HasSubstr("/nowhere/daemon.toml"));
  EXPECT_THAT(input_error_of([&] { read_config("/", options); }), HasSubstr("cannot be read"));
}

TEST(CommandLine, WinsOverTheConfigFileAndThatOverThePreset) {
  const ScratchFolder folder;
  const auto file = folder.write("daemon.toml", "filter = 4\nthreshold = 3\nrefine = true\n").string();
  const auto options =
      serve_options({"--filter", "2", "--config", file, "--preset", "avango", "--max-sessions", "5"});
  EXPECT_EQ(options.filter, 2u);
  EXPECT_EQ(options.threshold, 3.0);
  EXPECT_TRUE(options.refine);
  EXPECT_EQ(options.max_sessions, 5u);
}

TEST(CommandLine, SwitchesOffForThePaperWhatIsOurs) {
  const DaemonOptions paper = serve_options({"serve", "--preset", "avango"});
  EXPECT_EQ(paper.filter, 8u);
  EXPECT_EQ(paper.threshold, 0.0);
  EXPECT_FALSE(paper.refine);
  EXPECT_FALSE(paper.open);
  EXPECT_FALSE(paper.extents);
}

TEST(CommandLine, HasThePapersDefaults) {
  const DaemonOptions options = serve_options({});
  EXPECT_EQ(options.size, (ImageSize{512, 384}));
  EXPECT_EQ(options.engine.engine, "auto");
  EXPECT_EQ(options.engine.counter, "") << "each engine's first";
  EXPECT_EQ(options.engine.threads, 0u) << "one a core";
  EXPECT_EQ(options.engine.context, "osmesa");
  EXPECT_EQ(options.filter, 8u);
  EXPECT_EQ(options.threshold, 0.0);
  EXPECT_TRUE(options.refine);
}

TEST(CommandLine, NamesTheOptionItRefuses) {
  const std::pair<std::vector<std::string>, const char*> refused[] = {
      {{"--size", "0x0"}, "--size"},
      {{"--size", "1000000x1000000"}, "--size"},
      {{"--filter", "many"}, "--filter"},
      {{"--threshold", "1e"}, "--threshold"},
      {{"--control-rate", "-1"}, "--control-rate"},
      {{"--preset", "paper"}, "--preset"},
      {{"--no-such-option"}, "--no-such-option"},
      {{"fly"}, "fly"},
      {{"serve", "bench"}, "bench"},
      {{"bench", "--scene", "x"}, "--path"},
      {{"ping", "--connect", "tcp://x:1", "--timeout", "-2"}, "--timeout"},
      {{"keygen"}, "--out"},
  };
  for (const auto& entry : refused) {
    EXPECT_THAT(input_error_of([&] { (void)parse_command_line(entry.first); }),
                AllOf(HasSubstr(entry.second), Not(HasSubstr("\n"))));
  }
}

TEST(CommandLine, TakesSeveralEnginesForABench) {
  const auto options =
      std::get<BenchOptions>(parse_command_line({"bench", "--scene", "s", "--path", "p", "--json", "j",
                                                 "--engine", "item_buffer,item_buffer:queries"}));
  EXPECT_EQ(options.engines, (std::vector<std::string>{"item_buffer", "item_buffer:queries"}));
}

TEST(CommandLine, PrintsHelpOfEveryCommand) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"--help"}, {"serve", "--help"}, {"bench", "--help"}, {"--version"}}) {
    EXPECT_FALSE(std::get<PrintCommand>(parse_command_line(arguments)).text.empty());
  }
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"--help"}, {"serve", "--help"}}) {
    const std::string help = std::get<PrintCommand>(parse_command_line(arguments)).text;
    for (const OptionField& field : daemon_option_fields()) {
      std::string option = "--" + std::string(field.name);
      std::replace(option.begin() + 2, option.end(), '_', '-');
      EXPECT_THAT(help, HasSubstr(option + " "));
    }
    EXPECT_THAT(help, HasSubstr("512x384"));
  }
}

TEST(DaemonOptions, AreShownAsTheyCanBeSet) {
  DaemonOptions options = preset_options("avango");
  options.threshold = 0.125;
  options.max_triangles = 12'345'678'901;
  options.scene = "a.glb";
  for (const OptionField& field : daemon_option_fields()) {
    const std::string shown = field.show(options);
    if (shown.empty()) continue;
    DaemonOptions read;
    set_option(read, field.name, shown, "test");
    EXPECT_EQ(field.show(read), shown) << field.name;
  }
}

}  // namespace
}  // namespace sightline
