#include <gtest/gtest.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "datasets/descriptions/setup.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/calibration_views.hpp"

namespace clearway {
namespace calibrate_test {

using Json = nlohmann::json;

/// A folder of rendered pictures of the board that `tags print` lays out.
class CalibratePictures : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run_command({"tags", "print", "--out", folder_.file("sheets")}).status, exit_done);
    setup_ = folder_.file("sheets/setup.yaml");
    const clearway::Setup setup = load_setup(setup_);
    for (const TagSetup& tag : setup.board("calibration")->tags)
      board_.tags[tag.id] = {tag.size, tag.board_from_tag};
    board_.name = "calibration";
    camera_ = scene::distorted_camera();
  }

  /// @param nearer how much nearer the board is held, so that a wide lens sees its tags as large
  void render(const std::string& name, int count, double tilt, double nearer = 1.0) {
    std::mt19937 random(12);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::filesystem::create_directory(folder_ / name);
    for (int i = 0; i < count; ++i) {
      const Eigen::Isometry3d pose = scene::tag_before_camera(
          nearer * (0.42 + 0.06 * unit(random)), tilt * std::abs(unit(random)), M_PI * unit(random),
          M_PI * unit(random), 0.09 * unit(random), 0.06 * unit(random));
      char file[32];
      std::snprintf(file, sizeof file, "%s/%03d.png", name.c_str(), i);
      scene::Look look;
      look.seed = static_cast<unsigned>(i);
      look.supersample = 1;
      cv::imwrite(folder_.file(file), scene::render(camera_, scene::placed(board_, pose), look));
    }
  }

  /// What most cases ask about: rendered by the first one.
  void render_usual() {
    static const TemporaryFolder rendered;
    if (!std::filesystem::exists(rendered / "pictures")) {
      render("pictures", 16, 0.7);
      std::filesystem::copy(folder_ / "pictures", rendered / "pictures");
    } else {
      std::filesystem::copy(rendered / "pictures", folder_ / "pictures");
    }
  }

  TemporaryFolder folder_;
  std::string setup_;
  TagBody board_;
  Camera camera_;
};

TEST_F(CalibratePictures, CameraIsFoundWithinItsErrorsAndTheCopyOfTheSetupReadsBack) {
  render_usual();
  const std::vector<std::string> command{"calibrate", "camera", folder_.file("pictures"), "--board", setup_};
  std::vector<std::string> with_out = command;
  with_out.insert(with_out.end(), {"--out", folder_.file("mine.yaml"), "--threads", "2"});
  const CommandRun run = run_command(with_out);
  ASSERT_EQ(run.status, exit_done) << run.log << run.out;
  EXPECT_NE(run.out.find("held out"), std::string::npos) << run.out;
  const clearway::Setup found = load_setup(folder_.file("mine.yaml"));
  ASSERT_TRUE(found.camera && found.errors.camera.focal);
  EXPECT_LT(std::abs(std::log(found.camera->fx / camera_.fx)), 4.0 * *found.errors.camera.focal);
  EXPECT_LT(std::abs(found.camera->cx - camera_.cx), 4.0 * *found.errors.camera.center + 0.1);
  EXPECT_LT(*found.errors.camera.focal, 0.005);
  EXPECT_EQ(found.boards.size(), 4U);  // all else stays
  std::vector<std::string> as_json = command;
  as_json.insert(as_json.end(), {"--json", "--threads", "1"});
  const Json json = Json::parse(run_command(as_json).out);
  EXPECT_EQ(json["accepted"], true);
  EXPECT_LT(json["held_out_m"].get<double>(), 0.0005);
  EXPECT_LT(json["aspect_sigma"].get<double>(), 0.001);
  EXPECT_LT(std::abs(json["print_stretch"].get<double>()), 0.002);
  EXPECT_GT(json["roll_rad"].get<double>(), M_PI / 4.0);
  EXPECT_NE(read_file(folder_.file("mine.yaml")).find(json["setup"].get<std::string>().substr(0, 60)),
            std::string::npos);  // the same on any threads
}

TEST_F(CalibratePictures, AFisheyeIsFoundWithinItsErrorsAndTheSetupNamesItsLens) {
  camera_ = scene::fisheye_camera();
  render("pictures", 20, 0.7, 0.35);
  const CommandRun run = run_command({"calibrate", "camera", folder_.file("pictures"), "--board", setup_,
                                      "--lens", "fisheye", "--out", folder_.file("mine.yaml")});
  ASSERT_EQ(run.status, exit_done) << run.log << run.out;
  const clearway::Setup found = load_setup(folder_.file("mine.yaml"));
  EXPECT_EQ(found.camera->lens, LensModel::fisheye);
  EXPECT_LT(std::abs(std::log(found.camera->fx / camera_.fx)), 4.0 * *found.errors.camera.focal);
  EXPECT_LT(std::abs(found.camera->cx - camera_.cx), 4.0 * *found.errors.camera.center + 0.1);
  EXPECT_LT(*found.errors.camera.focal, 0.005);
}

TEST_F(CalibratePictures, ARationalLensIsFoundAndReadBackByOtherCommands) {
  std::mt19937 random(2);
  camera_ = scene::drawn_rational(random);
  render("pictures", 24, 0.7, 0.35);
  const std::vector<std::string> command{"calibrate", "camera", folder_.file("pictures"), "--board", setup_,
                                         "--threads", "2"};
  std::vector<std::string> rational = command;
  rational.insert(rational.end(), {"--lens", "rational", "--out", folder_.file("mine.yaml")});
  const CommandRun run = run_command(rational);
  ASSERT_EQ(run.status, exit_done) << run.log << run.out;
  for (const char* words : {"held out", "divisor", "other lenses", "plumb_bob "})
    EXPECT_NE(run.out.find(words), std::string::npos) << run.out;
  const clearway::Setup found = load_setup(folder_.file("mine.yaml"));
  EXPECT_EQ(found.camera->lens, LensModel::rational);
  EXPECT_LT(std::abs(std::log(found.camera->fx / camera_.fx)), 4.0 * *found.errors.camera.focal);
  EXPECT_LT(std::abs(found.camera->cx - camera_.cx), 4.0 * *found.errors.camera.center + 0.1);
  const CommandRun plumb_bob = run_command(command);
  EXPECT_EQ(plumb_bob.status, exit_no) << plumb_bob.out;
  EXPECT_NE(plumb_bob.log.find("take a rational or fisheye lens"), std::string::npos) << plumb_bob.log;
  const CommandRun track =
      run_command({"track", folder_.file("pictures"), "--setup", folder_.file("mine.yaml"), "--json"});
  ASSERT_EQ(track.status, exit_done) << track.log;
  EXPECT_EQ(Json::parse(track.out)["images"].size(), 24U);
}

TEST_F(CalibratePictures, ARationalLensOfANarrowCameraIsRefusedAndWritesNothing) {
  render_usual();
  const CommandRun run = run_command({"calibrate", "camera", folder_.file("pictures"), "--board", setup_,
                                      "--lens", "rational", "--out", folder_.file("none.yaml"), "--json"});
  EXPECT_EQ(run.status, exit_no);
  const Json json = Json::parse(run.out);
  EXPECT_EQ(json["accepted"], false);
  EXPECT_LT(json["held_out_plumb_bob_px"].get<double>(), 1.01 * json["held_out_px"].get<double>());
  EXPECT_NE(run.log.find("do not determine a rational lens"), std::string::npos) << run.log;
  EXPECT_FALSE(std::filesystem::exists(folder_.file("none.yaml")));
}

TEST_F(CalibratePictures, FrontalPicturesAndBadInputAreRefusedWithTheReasonAndWriteNothing) {
  render("frontal", 10, 0.02);
  const CommandRun frontal = run_command({"calibrate", "camera", folder_.file("frontal"), "--setup", setup_,
                                          "--out", folder_.file("none.yaml")});
  EXPECT_EQ(frontal.status, exit_no);
  EXPECT_NE(frontal.log.find("tilt it by 20 to 45 degrees"), std::string::npos) << frontal.log;
  EXPECT_FALSE(std::filesystem::exists(folder_.file("none.yaml")));
  for (const auto& [arguments, words] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"camera", folder_.file("frontal"), "--setup", setup_, "--out", setup_}, "is read by --setup"},
           {{"camera", folder_.file("frontal"), "--setup", setup_, "--body", "nobody"}, "no board 'nobody'"},
           {{"board", folder_.file("frontal"), "--setup", setup_}, "has the camera"},
           {{"probe", folder_.file("frontal"), "--setup", setup_}, "has the camera"},
           {{"board", folder_.file("frontal"), "--setup", setup_, "--lens", "fisheye"}, "--lens is of"},
           {{"camera", folder_.file("frontal"), "--setup", setup_, "--lens", "omni"}, "--lens"},
           {{"lens", folder_.file("frontal"), "--setup", setup_}, "calibrate: "},
           {{"camera", folder_.file("nowhere"), "--setup", setup_}, "nowhere"}}) {
    std::vector<std::string> command{"calibrate"};
    command.insert(command.end(), arguments.begin(), arguments.end());
    const CommandRun run = run_command(command);
    EXPECT_EQ(run.status, exit_bad_input) << words;
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find(words), std::string::npos) << run.log;
  }
}

TEST_F(CalibratePictures, ImagesOfAnotherSizeThanMostAreLeftOutAndToldWhicheverComesFirst) {
  render_usual();
  for (int i = 0; i < 3; ++i) {
    const std::string name = std::to_string(i);
    cv::Mat turned;
    cv::rotate(cv::imread(folder_.file("pictures/00" + name + ".png"), cv::IMREAD_GRAYSCALE), turned,
               cv::ROTATE_90_CLOCKWISE);
    cv::imwrite(folder_.file("pictures/000_" + name + ".png"), turned);
  }
  std::filesystem::rename(folder_ / "pictures/000_0.png", folder_ / "pictures/000.png");  // the first one
  const CommandRun run = run_command({"calibrate", "camera", folder_.file("pictures"), "--board", setup_,
                                      "--out", folder_.file("mine.yaml"), "--threads", "2"});
  ASSERT_EQ(run.status, exit_done) << run.log << run.out;
  EXPECT_NE(run.log.find("warning: 3 of 18 images"), std::string::npos) << run.log;
  EXPECT_NE(run.log.find("another size than most, 640 x 480 pixels"), std::string::npos) << run.log;
  EXPECT_EQ(load_setup(folder_.file("mine.yaml")).camera->width, camera_.width);
}

TEST_F(CalibratePictures, ThatEqualPicturesDoNotCountIsSaid) {
  render("pictures", 1, 0.7);
  for (int i = 1; i < 12; ++i)
    std::filesystem::copy(folder_ / "pictures/000.png",
                          folder_ / ("pictures/copy" + std::to_string(i) + ".png"));
  const CommandRun run =
      run_command({"calibrate", "camera", folder_.file("pictures"), "--board", setup_, "--threads", "2"});
  EXPECT_EQ(run.status, exit_no);
  EXPECT_NE(run.log.find("of 12 that show the board 11 are like others and 0 were taken while it moved"),
            std::string::npos)
      << run.log;
}

TEST_F(CalibratePictures, ABoardThatIsNotInThePicturesOrNotAsItsSetupHasItIsTold) {
  render_usual();
  const auto refusal = [&](const std::vector<std::string>& more) {
    std::vector<std::string> command{"calibrate", "camera", folder_.file("pictures"), "--threads", "2"};
    command.insert(command.end(), more.begin(), more.end());
    return run_command(command).log;
  };
  const std::string other = refusal({"--board", setup_, "--body", "base"});
  EXPECT_NE(other.find("seen instead: board 'calibration' in 16 images"), std::string::npos) << other;
  std::string text = read_file(setup_);
  const std::string middle = "- {id: 8, size: 0.0238, pose_deg: [0, ";
  const std::size_t tag = text.find(middle, text.find("name: calibration"));
  ASSERT_NE(tag, std::string::npos);
  folder_.write("moved.yaml", text.substr(0, tag) + "- {id: 8, size: 0.0238, pose_deg: [0.034, " +
                                  text.substr(tag + middle.size()));
  const std::string moved = refusal({"--board", folder_.file("moved.yaml")});
  EXPECT_NE(moved.find("the corners miss the board as the setup has it by "), std::string::npos) << moved;
  folder_.write("none.yaml",
                "boards: [{name: b, tags: [{id: 500, size: 0.03, pose: [0, 0, 0, 0, 0, 0]}]}]\n");
  const std::string none = refusal({"--board", folder_.file("none.yaml")});
  EXPECT_NE(none.find("the tags that are seen (ids 0, 1, 2, "), std::string::npos) << none;
}

TEST_F(CalibratePictures, BoardWhoseSetupStatesAWrongSizeIsNamedAndMeasured) {
  render_usual();
  std::string text = read_file(setup_);
  const std::size_t tag = text.find("- {id: 4, size: ", text.find("name: calibration"));
  text.replace(tag, std::string("- {id: 4, size: 0.0238").size(), "- {id: 4, size: 0.0214");
  char camera[300];
  std::snprintf(camera, sizeof camera,
                "camera: {width: %d, height: %d, fx: %.9g, fy: %.9g, cx: %.9g, cy: %.9g, distortion: [%.9g, "
                "%.9g, %.9g, %.9g, %.9g]}\nerrors: {camera: {focal: 0.0005, center_px: 0.3, distortion_px: "
                "0.1}}\n",
                camera_.width, camera_.height, camera_.fx, camera_.fy, camera_.cx, camera_.cy,
                camera_.distortion[0], camera_.distortion[1], camera_.distortion[2], camera_.distortion[3],
                camera_.distortion[4]);
  folder_.write("wrong.yaml", camera + text);
  const CommandRun run = run_command({"calibrate", "board", folder_.file("pictures"), "--setup",
                                      folder_.file("wrong.yaml"), "--out", folder_.file("right.yaml")});
  ASSERT_EQ(run.status, exit_done) << run.log << run.out;
  EXPECT_NE(run.out.find("NOT AS STATED: 21.4 mm"), std::string::npos) << run.out;
  EXPECT_EQ(run.out.find("+- 0 "), std::string::npos) << run.out;  // of the tag that places are relative to
  const clearway::Setup right = load_setup(folder_.file("right.yaml"));
  for (const TagSetup& one : right.board("calibration")->tags)
    EXPECT_NEAR(one.size, 0.0238, 0.0238 * 0.004) << one.id;
  EXPECT_LT(*right.board("calibration")->errors.place, 0.0005);

  // All sizes are 5 % too small, the places are not: either may be wrong, and nothing is written.
  text = read_file(setup_);
  const std::string size = "size: 0.0238";
  for (std::size_t at = text.find("name: calibration"); (at = text.find(size, at)) != std::string::npos;)
    text.replace(at, size.size(), "size: 0.0226");
  folder_.write("small.yaml", camera + text);
  const CommandRun small = run_command({"calibrate", "board", folder_.file("pictures"), "--setup",
                                        folder_.file("small.yaml"), "--out", folder_.file("none.yaml")});
  EXPECT_EQ(small.status, exit_no);
  EXPECT_NE(small.log.find("distances between tags are 5.0"), std::string::npos) << small.log;
  EXPECT_TRUE(small.complains_in_one_sentence()) << small.log;
  EXPECT_EQ(small.out.find("SIZE IS NOT AS STATED"), std::string::npos) << small.out;
  EXPECT_FALSE(std::filesystem::exists(folder_.file("none.yaml")));
}

}  // namespace calibrate_test
}  // namespace clearway
