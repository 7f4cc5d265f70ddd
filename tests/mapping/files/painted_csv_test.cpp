#include "mapping/files/painted_csv.hpp"

#include <gtest/gtest.h>

#include "mapping/files/map_digest.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/files/map_leaves.hpp"
#include "mapping/free_space_map.hpp"
#include "tests/worlds/random_map.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace painted_csv_test {

std::vector<PaintedVolume> awkward_volumes() {
  worlds::Dice dice(1);
  std::vector<PaintedVolume> volumes = {
      {"plain", {"tool", "load"}}, {"a \"quoted\", label", {"semi;colon", "back\\slash"}}, {"", {}}};
  volumes[0].strokes = {{"first, \"quoted\"", "camera"}, {"", ""}};
  for (int i = 0; i < 200; ++i) {
    PaintedVolume& volume = volumes[static_cast<std::size_t>(i) % 2];
    const int stroke = i < 20 || i % 2 == 1 ? -1 : (i / 30) % 2;
    volume.add({dice.point(3.0) * std::pow(10.0, dice.uniform(-9, 3)), dice.uniform(1e-9, 2.0)},
               dice.uniform(0, 1.7e9), stroke);
  }
  return volumes;
}

void expect_same(const std::vector<PaintedVolume>& a, const std::vector<PaintedVolume>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t v = 0; v < a.size(); ++v) {
    EXPECT_EQ(a[v].label, b[v].label);
    EXPECT_EQ(a[v].critical_parts, b[v].critical_parts);
    EXPECT_EQ(a[v].times, b[v].times);
    EXPECT_EQ(a[v].strokes, b[v].strokes);
    EXPECT_EQ(a[v].stroke_of, b[v].stroke_of);
    ASSERT_EQ(a[v].spheres.size(), b[v].spheres.size());
    for (std::size_t i = 0; i < a[v].spheres.size(); ++i) {
      EXPECT_EQ(a[v].spheres[i].center, b[v].spheres[i].center);  // the same bits
      EXPECT_EQ(a[v].spheres[i].radius, b[v].spheres[i].radius);
    }
  }
}

TEST(PaintedCsv, ReadsBackTheSameBits) {
  const std::vector<PaintedVolume> volumes = awkward_volumes();
  const std::string text = format_painted(volumes);
  expect_same(parse_painted(text, "painted.csv"), volumes);
  EXPECT_EQ(format_painted(parse_painted(text, "painted.csv")), text);
  EXPECT_TRUE(parse_painted(format_painted({}), "painted.csv").empty());
}

TEST(PaintedCsv, RefusesATextThatIsCutInALine) {
  const std::string text = format_painted(awkward_volumes());
  for (std::size_t length = 0; length < text.size(); length += length < 2000 ? 1 : 37) {
    if (length > 0 && text[length - 1] == '\n') continue;  // whole lines
    EXPECT_THROW(parse_painted(text.substr(0, length), "painted.csv"), DamagedFile) << length;
  }
}

TEST(PaintedCsv, NamesTheLineAndWhatWasExpected) {
  std::string head = "volume,label,critical_parts,x,y,z,radius,time\n";
  const auto refusal = [&](const std::string& lines) -> std::string {
    try {
      parse_painted(head + lines, "p.csv");
    } catch (const DamagedFile& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal("0,\"a\",\"\",0,0,0,1,0\n"), "");
  EXPECT_EQ(refusal("0,a,,0,0,0,1,0\n"), "");  // quotes are optional
  EXPECT_NE(refusal("0,a,,0,0,0,0,0\n").find("'p.csv' line 2: expected a radius > 0"), std::string::npos);
  EXPECT_NE(refusal("0,a,,nan,0,0,1,0\n").find("finite number for x"), std::string::npos);
  EXPECT_EQ(refusal("0,a,,0,0,0,1\n"), "'p.csv' line 2: expected 8 values, one for each column, found 7");
  EXPECT_NE(refusal("0,a,,0,0,,1,0\n").find("finite number for z"), std::string::npos);
  EXPECT_NE(refusal("1,a,,0,0,0,1,0\n").find("in order"), std::string::npos);
  EXPECT_NE(refusal("0,a,,0,0,0,1,0\n0,b,,0,0,0,1,0\n").find("same label"), std::string::npos);
  EXPECT_NE(refusal("0,a,,0,0,0,1,0\n1,a,,0,0,0,1,0\n").find("label of its own"), std::string::npos);
  EXPECT_EQ(refusal("0,\"a,,0,0,0,1,0\n"),
            "'p.csv' line 2: expected quotes that end on the line where they begin");
  head = "x,y,z\n";
  EXPECT_EQ(refusal(""),
            "'p.csv' line 1: expected the columns volume,label,critical_parts,x,y,z,radius,time, and "
            "stroke,stroke_label,source behind them or none of these");
}

TEST(PaintedCsv, APartWithoutANameIsNone) {
  const std::string head = "volume,label,critical_parts,x,y,z,radius,time\n";
  for (const char* parts : {"hand;", ";hand", "hand;;"})
    EXPECT_EQ(parse_painted(head + "0,a," + parts + ",0,0,0,1,0\n", "p.csv")[0].critical_parts,
              std::vector<std::string>{"hand"})
        << parts;
  EXPECT_TRUE(parse_painted(head + "0,a,;,0,0,0,1,0\n", "p.csv")[0].critical_parts.empty());
}

TEST(PaintedCsv, AStrokeThatIsWhollyErasedIsNotWritten) {
  PaintedVolume volume{"v", {}};
  volume.strokes = {{"erased", "hand"}, {"left", "hand"}};
  volume.add({{1.0, 2.0, 3.0}, 0.1}, 5.0, 1);
  const auto read = parse_painted(format_painted({volume}), "p.csv");
  ASSERT_EQ(read[0].strokes.size(), 1U);
  EXPECT_EQ(*read[0].stroke(0), (Stroke{"left", "hand", 5.0, 5.0}));
}

TEST(PaintedCsv, RefusesStrokesThatContradictThemselves) {
  const std::string head = "volume,label,critical_parts,x,y,z,radius,time,stroke,stroke_label,source\n";
  const auto refusal = [&](const std::string& lines) -> std::string {
    try {
      parse_painted(head + lines, "p.csv");
    } catch (const DamagedFile& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal("0,a,,0,0,0,1,0,0,s,me\n0,a,,0,0,0,1,0,,,\n0,a,,0,0,0,1,0,0,s,me\n"), "");
  EXPECT_NE(refusal("0,a,,0,0,0,1,0,1,s,me\n").find("in order"), std::string::npos);
  EXPECT_NE(refusal("0,a,,0,0,0,1,0,0.5,s,me\n").find("in order"), std::string::npos);
  EXPECT_NE(refusal("0,a,,0,0,0,1,0,-1,s,me\n").find("in order"), std::string::npos);
  EXPECT_NE(refusal("0,a,,0,0,0,1,0,0,s,me\n0,a,,0,0,0,1,0,0,t,me\n").find("same label"), std::string::npos);
  EXPECT_NE(refusal("0,a,,0,0,0,1,0\n").find("expected 11 values, one for each column, found 8"),
            std::string::npos);
}

TEST(PaintedCsv, SurvivesRandomDamage) {
  const std::string text = format_painted(awkward_volumes());
  worlds::Dice dice(2);
  for (int i = 0; i < 2000; ++i) {
    std::string damaged = text;
    damaged[static_cast<std::size_t>(dice.whole(0, static_cast<int>(text.size()) - 1))] ^=
        static_cast<char>(1 << dice.whole(0, 7));
    try {
      for (const PaintedVolume& volume : parse_painted(damaged, "p.csv")) {
        for (const Sphere& sphere : volume.spheres)
          ASSERT_TRUE(sphere.center.allFinite() && sphere.radius > 0.0);
      }
    } catch (const DamagedFile&) {
    }
  }
}

TEST(PaintedCsv, beside_our_own_map_it_is_a_copy_and_whoever_changes_it_is_warned_that_it_is_not_used) {
  const TemporaryFolder folder;
  FreeSpaceMap map({.resolution = 0.05});
  const int volume = map.add_volume("tool", {"hand"});
  map.paint(volume, {{0.1, 0.2, 0.3}, 0.2});
  save_map(map.snapshot(), folder.path());
  const auto remark = [&] { return painted_csv_remark(folder.path(), load_map(folder.path())); };
  EXPECT_EQ(remark(), "");
  const std::string text = read_file(folder / "painted.csv");
  std::string larger = text;
  larger.replace(larger.find(",0.2,0,"), 4, ",0.9");
  for (const std::string& changed : {larger, std::string("hello"), std::string()}) {
    write_file(folder / "painted.csv", changed);
    EXPECT_NE(remark().find("painted.csv' differs from the painted volumes in map.ot and is not used"),
              std::string::npos)
        << remark();
    EXPECT_EQ(load_map(folder.path()).volumes()[0].spheres[0].radius, 0.2);
  }
  write_file(folder / "painted.csv", text);
  export_map(map.snapshot(), folder / "map.ot");  // a tree of another program, without volumes
  EXPECT_EQ(load_map(folder.path()).volumes().size(), 1u);
  EXPECT_NE(remark().find("because map.ot holds none"), std::string::npos) << remark();
}

TEST(PaintedCsv, its_balls_paint_a_map_of_another_program) {
  const TemporaryFolder folder;
  worlds::Dice dice(4);
  FreeSpaceMap map({.resolution = 0.05});
  const int first = map.add_volume("tool", {"hand"}), second = map.add_volume("arm, long", {"elbow"});
  for (int i = 0; i < 30; ++i)
    map.paint(i % 2 == 0 ? first : second,
              {{dice.uniform(-1, 1), dice.uniform(-1, 1), dice.uniform(0, 1)}, 0.2});
  Scan scan;
  for (int i = 0; i < 400; ++i) scan.points.emplace_back(dice.uniform(-1, 1), dice.uniform(-1, 1), 1.0f);
  map.insert(scan);
  const Snapshot before = map.snapshot();
  save_map(before, folder.path());
  export_map(before, folder / "map.ot");
  std::string text = read_file(folder / "painted.csv"), spreadsheet = "\xEF\xBB\xBF";
  for (const char c : text) spreadsheet += c == '\n' ? std::string("\r\n") : std::string(1, c);
  write_file(folder / "painted.csv", spreadsheet);
  const Snapshot after = load_map(folder.path());
  for (int i = 0; i < 20'000; ++i) {
    const Eigen::Vector3d point(dice.uniform(-1.3, 1.3), dice.uniform(-1.3, 1.3), dice.uniform(-0.3, 1.3));
    ASSERT_EQ(after.state(point), before.state(point)) << point.transpose();
    ASSERT_EQ(after.voxel(point).volumes, before.voxel(point).volumes);
  }
  const VoxelCounts read = MapLeaves::in_file(folder.path()).counts(), expected = MapLeaves(before).counts();
  EXPECT_EQ(read.painted, expected.painted);
  EXPECT_GT(read.painted, 100U);
  EXPECT_EQ(read.seen_free, expected.seen_free);
  EXPECT_EQ(MapLeaves::in_file(folder.path()).sha256().size(), 64U);
}

TEST(PaintedCsv, belongs_to_the_digest_of_a_map_whose_paint_it_is_and_to_no_other) {
  const TemporaryFolder folder;
  FreeSpaceMap map({.resolution = 0.05});
  const int volume = map.add_volume("tool", {"hand"});
  map.paint(volume, {{0.1, 0.2, 0.3}, 0.2});
  save_map(map.snapshot(), folder.path());
  const std::string one = read_file(folder / "painted.csv");
  map.paint(volume, {{0.6, 0.2, 0.3}, 0.2});
  const std::string two = format_painted(map.snapshot().volumes());
  const auto digest_with = [&](const std::string& text) {
    write_file(folder / "painted.csv", text);
    const std::string digest = map_sha256(folder.path());
    EXPECT_EQ(MapLeaves::in_file(folder.path()).sha256(), digest);
    return digest;
  };
  const std::string own = file_sha256(folder / "map.ot");
  EXPECT_EQ(digest_with(one), own);
  EXPECT_EQ(digest_with(two), own) << "a map of ours holds its paint";
  export_map(map.snapshot(), folder / "map.ot");  // a tree of another program
  const std::string bare = file_sha256(folder / "map.ot");
  EXPECT_EQ(digest_with(format_painted({})), bare);
  EXPECT_EQ(digest_with(one), sha256(read_file(folder / "map.ot") + one));
  EXPECT_NE(digest_with(two), digest_with(one));
  EXPECT_EQ(map_sha256(folder / "map.ot"), bare) << "the file alone has no paint";
}

}  // namespace painted_csv_test
}  // namespace clearway
