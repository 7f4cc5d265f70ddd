// clearway teach: what is refused before a session begins.

#include <gtest/gtest.h>

#include "apps/teach/teach_event.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/free_space_map.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/datasets/complaint.hpp"

namespace clearway {
namespace teach_test {

TEST(Teach, WhatIsWrongIsReportedInOneSentence) {
  const TemporaryFolder folder;
  const std::string recording = "/usr/share/mrpt/datasets/localization_demo.rawlog";
  const auto refusal = [&](const std::string& line) {
    folder.write("e.jsonl", line);
    const CommandRun run =
        run_command({"teach", recording, "--events", folder.file("e.jsonl"), "--out", folder.file("out")});
    EXPECT_EQ(run.status, exit_bad_input) << line;
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
    return run.log;
  };
  const auto expect = [&](const std::string& line, const std::string& part) {
    const std::string sentence = refusal(line);
    EXPECT_NE(sentence.find(part), std::string::npos) << sentence;
  };
  expect("{\"time\": 0}", "e.jsonl', line 1: field 'action'");
  expect("{\"time\": 0, \"action\": \"pant_on\"}",
         "field 'action': unknown action 'pant_on': did you mean 'paint_on'?");
  expect("{\"time\": -1, \"action\": \"paint_on\"}", "seconds after the first frame, 0 or more");
  expect("{\"time\": 1700000000.5, \"action\": \"paint_on\"}", "not since 1970");
  expect("{\"time\": 0, \"action\": \"paint_on\", \"lable\": \"x\"}",
         "field 'lable': action 'paint_on' has no such field: expected one of action, time");
  expect("{\"time\": 2, \"action\": \"paint_on\"}\n{\"time\": 1, \"action\": \"paint_off\"}",
         "line 2: field 'time': expected a time not before the last line's");
  expect("{\"time\": 0, \"action\": \"plan\", \"name\": \"../x\"}", "letters, digits");
  expect("{\"time\": 0, \"action\": \"plan\", \"planner\": \"bem\"}", "bem");
  expect("{\"time\": 0, \"action\": \"robot\", \"robot\": \"arm6\", \"fixed\": {\"a=b\": 1}}",
         "the name of a joint, without '='");
  expect("{\"time\": 0, \"action\": \"robot\", \"robot\": \"nosuch.urdf\"}", "nosuch.urdf");
  expect("{\"time\": 0, \"action\": \"robot\", \"robot\": \"arm6\", \"policies\": {\"tol\": \"painted\"}}",
         "e.jsonl', at 0 s, robot: policies: robot 'arm6' has no part 'tol'");
  const auto expect_load = [&](const std::string& fields, const std::string& part) {
    expect("\n{\"time\": 0, \"action\": \"attach\", " + fields + "}", part);
  };
  expect_load("\"load\": {\"name\": \"can\", \"sphere\": -1, \"link\": \"hand\"}",
              "e.jsonl', line 2: field 'load', sphere: ");
  expect_load("\"load\": {\"name\": \"can\", \"sphere\": 1, \"lnk\": \"hand\"}", "field 'load', link: ");
  expect_load("\"load\": {\"name\": \"can\", \"sphere\": 1, \"link\": \"hand\", \"legs\": [1]}",
              "no 'legs': a load rides from 'attach' to 'detach'");
  expect_load("\"load\": [1]", "field 'load'");
  expect_load("\"load\": {}, \"name\": \"can\"", "either 'load', a load, or 'name'");
  expect_load("\"q\": \"1\"", "field 'q': action 'attach' has no such field: expected one of ");
  expect_load("\"name\": \"can\"", "at 0 s, attach: the setup has no load 'can'");
  expect_load("\"load\": {\"name\": \"can\", \"mesh\": \"no.stl\", \"link\": \"hand\"}", "no.stl");
  expect("{\"time\": 0, \"action\": \"object\"}", "field 'name'");
  expect("{\"time\": 0, \"action\": \"object\", \"name\": \"a\", \"mass\": -1}", "a number from 0 to 1e6");
  expect("{\"time\": 0, \"action\": \"pick\", \"approach\": [0, 1]}", "field 'approach'");
  expect("{\"time\": 0, \"action\": \"volume\", \"label\": \"a\", \"critical_parts\": [\"\"]}", "a word");
  expect("nothing", "e.jsonl', line 1 is not valid JSON at column 1");
}

TEST(Teach, TheSetupsRobotMovesWhatTheSetupSaysWhereAnEventChoosesIt) {
  const TemporaryFolder folder;
  const std::string setup = folder.write("s.yaml", "robot: {name: planar2, fixed: {elbow: 0.3}}\n");
  const std::string events = folder.write(
      "e.jsonl", "{\"time\": 0, \"action\": \"robot\", \"robot\": \"planar2\", \"near\": [0.1, 0.2]}");
  const CommandRun run = run_command({"teach", "/usr/share/mrpt/datasets/localization_demo.rawlog", "--setup",
                                      setup, "--events", events, "--out", folder.file("out")});
  EXPECT_EQ(run.status, exit_bad_input);
  EXPECT_NE(run.log.find("near: got 2 values, expected 1, one for each joint of robot 'planar2'"),
            std::string::npos)
      << run.log;
}

TEST(Teach, SecondsAreThoseOfALiveCamera) {
  for (const std::vector<std::string>& begin :
       {std::vector<std::string>{"teach", "--out", "nowhere"}, {"replay", "--out", "nowhere"}, {"track"}}) {
    std::vector<std::string> arguments = begin;
    arguments.insert(arguments.end(), {"r.rawlog", "--seconds", "5"});
    const CommandRun run = run_command(arguments);
    EXPECT_EQ(run.status, exit_bad_input) << begin[0];
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find("--seconds: expected a live camera (--camera N), got 'r.rawlog'"),
              std::string::npos)
        << run.log;
  }
}

TEST(Teach, KeysAreReadBeforeTheSessionAndAreForTheWindow) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& keys, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"teach",  "/usr/share/mrpt/datasets/localization_demo.rawlog",
                                          "--keys", folder.write("k.jsonl", keys),
                                          "--out",  folder.file("out")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const CommandRun run = run_command(arguments);
    EXPECT_EQ(run.status, exit_bad_input);
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    return run.log;
  };
  EXPECT_NE(refusal("{\"key\": \"1\", \"action\": \"robot\", \"robot\": \"no.urdf\"}", {})
                .find("k.jsonl', key '1', robot: "),
            std::string::npos);
  const std::string fine = "{\"key\": \"1\", \"action\": \"robot\", \"robot\": \"arm6\"}";
  EXPECT_NE(refusal(fine, {"--events", folder.write("e.jsonl", "")}).find("--keys: expected no --events"),
            std::string::npos);
  EXPECT_NE(refusal("{\"key\": 1}", {}).find("k.jsonl', line 1"), std::string::npos);
}

TEST(Teach, ARecordedSessionTakesNoOtherSettings) {
  const TemporaryFolder folder;
  folder.write("session.json", "{}");
  const auto expect = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--out", folder.file("out")});
    const CommandRun run = run_command(arguments);
    EXPECT_EQ(run.status, exit_bad_input);
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find("is a recorded session"), std::string::npos) << run.log;
  };
  const std::string session = folder.file(".");
  expect({"replay", session, "--setup", "nosuch.yaml"});
  expect({"replay", session, "--no-plan"});
  expect({"replay", session, "--seed", "2"});
  expect({"teach", session, "--events", "nosuch.jsonl"});
  expect({"teach", session, "--resolution", "0.1"});
}

TEST(Teach, NothingIsWrittenOverTheRecordingOrIntoIt) {
  const TemporaryFolder folder;
  folder.write("s.yaml", "map: {resolution: 0.1}\n");
  folder.write("r.mp4", "a recording");
  folder.write("e.mp4", "{\"time\": 0, \"action\": \"quit\"}");
  std::filesystem::create_directory(folder / "pictures");
  const auto expect = [&](const std::string& source, const std::string& out, const std::string& video,
                          const std::string& part) {
    const CommandRun run = run_command({"teach", folder.file(source), "--setup", folder.file("s.yaml"),
                                        "--events", folder.file("e.mp4"), "--headless", "--out",
                                        folder.file(out), "--video-out", folder.file(video)});
    EXPECT_EQ(run.status, exit_bad_input);
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find(part), std::string::npos) << run.log;
  };
  expect("pictures", "pictures/taught", "v.mp4", "lies in the recording");
  expect("pictures", "pictures", "v.mp4", "lies in the recording");
  expect("r.mp4", "taught", "r.mp4", "is read by SOURCE");
  expect("r.mp4", "taught", "e.mp4", "is read by --events");
  expect("r.mp4", "taught", "v.mkv", "--video-out: expected a file name that ends in .mp4, got '");
}

TEST(Teach, WhatASessionRecordedGoesWithNoOtherCommand) {
  const TemporaryFolder folder;
  save_map(FreeSpaceMap({.resolution = 0.1}).snapshot(), folder / "map");
  std::filesystem::create_directories(folder / "taught/session/source");
  std::filesystem::create_directories(folder / "taught/approved");
  const std::string recording =
      folder.write("taught/session/source/frames.rawlog", "all that there is of it");
  folder.write("taught/approved/plan.yaml", "a motion");
  folder.write("taught/.clearway_files", "approved/plan.yaml\nmap.ot\nsession/source/frames.rawlog\n");
  const std::string taught = folder.file("taught");
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"replay", recording, "--out", taught},
        {"replay", folder.file("nosuch.rawlog"), "--out", taught},
        {"inspect", folder.file("map"), "--coarsen", "0.2", "--save", taught},
        {"tags", "print", "--out", taught},
        {"compare", "quick", "--out", taught},
        {"track", folder.write("r.rawlog", ""), "--draw", taught, "--setup", "miniature_kitchen"}}) {
    const CommandRun run = run_command(command);
    EXPECT_EQ(run.status, exit_bad_input) << command[0];
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find("it holds 'approved/plan.yaml', which another command wrote"), std::string::npos)
        << command[0] << ": " << run.log;
  }
  EXPECT_EQ(read_file(recording), "all that there is of it");
  EXPECT_TRUE(std::filesystem::exists(folder / "taught/approved/plan.yaml"));
}

TEST(Teach, EventsAreReadBackAsTheyWere) {
  const TemporaryFolder folder;
  const std::string text =
      "{\"time\":0.0,\"action\":\"robot\",\"robot\":\"arm6\",\"scale\":0.5,\"base\":[0.0,1.0,2.0],\"group\":"
      "\"g\","
      "\"fixed\":{\"j\":0.25},\"policies\":{\"default\":\"known_free\",\"tool\":\"painted\"},\"padding\":0."
      "001,"
      "\"near\":[0.0,1.0]}\n"
      "{\"time\":0.4,\"action\":\"robot\",\"robot\":\"arm6\",\"base\":\"ball\"}\n"
      "{\"time\":0.5,\"action\":\"attach\",\"load\":{\"name\":\"can\",\"cylinder\":[0.03,0.1],\"link\":"
      "\"hand\",\"pose_deg\":[0.1,0,0,10,20,30.3],\"touches\":[\"finger\"]}}\n"
      "{\"time\":0.5,\"action\":\"attach\",\"name\":\"a cup\"}\n"
      "{\"time\":0.6,\"action\":\"detach\",\"name\":\"a cup\"}\n"
      "{\"time\":0.6,\"action\":\"detach\"}\n"
      "{\"time\":0.7,\"action\":\"object\",\"link\":\"hand\",\"mass\":0.25,\"touches\":[\"finger\"],\"name\":"
      "\"a can\"}\n"
      "{\"time\":0.7,\"action\":\"object\",\"name\":\"\"}\n"
      "{\"time\":0.8,\"action\":\"object_off\"}\n"
      "{\"time\":0.9,\"action\":\"pick\",\"approach\":[0.0,0.1,-0.1],\"lift\":0.2,\"contact\":0.05,\"q\":"
      "\"1\","
      "\"name\":\"a can\"}\n"
      "{\"time\":0.9,\"action\":\"place\",\"q\":\"1\"}\n"
      "{\"time\":1.0,\"action\":\"volume\",\"label\":\"a\",\"critical_parts\":[\"tool\"]}\n"
      "{\"time\":2.5,\"action\":\"start\",\"q\":\"0,1,2\"}\n"
      "{\"time\":3.0,\"action\":\"plan\",\"planner\":\"beam\",\"options\":{\"width\":\"20\"},\"name\":\"p\"}"
      "\n"
      "{\"time\":3.0,\"action\":\"quit\"}\n";
  folder.write("e.jsonl", text);
  std::string again;
  for (const TeachEvent& event : load_teach_events(folder / "e.jsonl")) again += to_json_line(event) + "\n";
  EXPECT_EQ(again, text);
  folder.write("e.jsonl", R"({"time": 0, "action": "robot", "robot": "arm6", "base": "probe"})");
  const std::string why = complaint([&] { load_teach_events(folder / "e.jsonl"); });
  EXPECT_NE(why.find("roll, pitch, yaw (m, rad), or \"ball\""), std::string::npos) << why;
}

TEST(Teach, EventsThatWouldFillTheMemoryAreRefused) {
  const TemporaryFolder folder;
  folder.write("e.jsonl", std::string(100'001, '\n'));
  EXPECT_THROW(load_teach_events(folder / "e.jsonl"), std::invalid_argument);
  folder.write("e.jsonl", std::string(100'000, '\n'));
  EXPECT_TRUE(load_teach_events(folder / "e.jsonl").empty());
}

TEST(Teach, ARobotsFileIsNamedFromTheFolderOfTheEvents) {
  const TemporaryFolder folder;
  folder.write("arm.urdf", "");
  const auto robot_of = [&](const std::string& named) {
    folder.write("e.jsonl", "{\"time\":0.5,\"action\":\"robot\",\"robot\":\"" + named + "\"}\n");
    return load_teach_events(folder / "e.jsonl").front().robot.robot;
  };
  EXPECT_EQ(robot_of("arm.urdf"), std::filesystem::weakly_canonical(folder / "arm.urdf").string());
  EXPECT_EQ(robot_of("other.urdf"), "other.urdf");  // from where the program runs
  EXPECT_EQ(robot_of("panda"), "panda");
}

TEST(Teach, ALoadsNameIsATextHoweverItIsWritten) {
  const TemporaryFolder folder;
  folder.write("e.jsonl",
               "{\"time\":0.5,\"action\":\"attach\",\"load\":{\"name\":5,\"box\":[0.1,0.1,0.1],"
               "\"link\":\"hand\"}}\n");
  const std::string line = to_json_line(load_teach_events(folder / "e.jsonl").front());
  EXPECT_NE(line.find("\"name\":\"5\""), std::string::npos) << line;
}

}  // namespace teach_test
}  // namespace clearway
