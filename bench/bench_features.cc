// SPDX-License-Identifier: Apache-2.0
// Tag detection in an image of 1280 x 720: the libraries' own calls, and ours with refinement and
// the board's pose. One thread. The corners are checked against the truth before timing.
// Backgrounds: a plain wall, and texture over the whole image.
#include <benchmark/benchmark.h>

extern "C" {
#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
}

#include <opencv2/imgproc.hpp>

#include "base/random.h"
#include "features/camera/find_boards.h"
#include "features/camera/tags/opencv_aruco.h"
#include "geometry/board_check.h"
#include "geometry/so3.h"
#include "simulator/camera/render.h"
#include "simulator/scene/camera_model.h"

namespace sextant {
namespace {

constexpr double kMaxError_px = 0.1;

struct Photo {
  cv::Mat image;
  Camera camera;
  Board board;
  Rigid3d cam_from_board;
};

// Four tags of about 60 px on a tilted board.
const Photo& ThePhoto() {
  static const Photo photo = [] {
    Photo made;
    made.camera = *FindCameraModel("zed_left");
    made.board = {.id = 0, .top_right_m = 0.6, .right_bottom_m = 0.6};
    int id = 1;
    for (const double x : {-0.15, 0.15}) {
      for (const double y : {-0.15, 0.15}) {
        made.board.tags.push_back(
            {.family = "tag36h11", .id = id++, .edge_m = 0.15, .center_in_board_m = {x, y}});
      }
    }
    made.cam_from_board.rotation = ExpSo3(Eigen::Vector3d(0.2, 0.3, 0.7));
    made.cam_from_board.translation = {0.1, 0.0, 1.7};
    Scene scene;
    scene.cameras.push_back({.name = "cam", .model = "zed_left"});
    scene.boards.push_back({.board = made.board, .world_from_board = made.cam_from_board});
    made.image = *RenderImage(scene, 0, {.seed = 1, .blur_sigma_px = 0.7, .noise_sigma_grey = 3.0});
    return made;
  }();
  return photo;
}

// Random grey levels with this sigma, smooth over this many pixels.
cv::Mat Blotches(const cv::Size& size, int over_px, double sigma_grey, Random& random) {
  cv::Mat_<float> small(size / over_px + cv::Size(1, 1));
  for (float& grey : small) grey = static_cast<float>(sigma_grey * random.Normal());
  cv::Mat large;
  cv::resize(small, large, size, 0.0, 0.0, cv::INTER_CUBIC);
  return large;
}

// The same with a background of blotches of all sizes.
const Photo& TheTexturedPhoto() {
  static const Photo photo = [] {
    Photo made = ThePhoto();
    const cv::Size size = made.image.size();
    Random random(2);
    cv::Mat texture(size, CV_32F, cv::Scalar(0.0));
    for (const int over_px : {3, 6, 12, 24, 48}) {
      texture += Blotches(size, over_px, 15.0, random);
    }
    std::vector<cv::Point> outline;
    for (const Eigen::Vector3d& corner : BoardCorners(made.board)) {
      const Eigen::Vector2d pixel = *Project(made.camera, made.cam_from_board * corner);
      outline.emplace_back(cvRound(pixel.x()), cvRound(pixel.y()));
    }
    cv::fillConvexPoly(texture, outline, cv::Scalar(0.0));
    cv::Mat sum;
    cv::add(made.image, texture, sum, {}, CV_8U);
    made.image = sum;
    return made;
  }();
  return photo;
}

void Ours(benchmark::State& state, const Photo& (*the_photo)(), const char* detector) {
  cv::setNumThreads(1);
  const Photo& photo = the_photo();
  const Expected<BoardFinder> finder = BoardFinder::Make({photo.board}, photo.camera, detector);
  if (!finder) return state.SkipWithError(finder.error().message.c_str());
  const Expected<SeenBoards> checked = finder->Find(photo.image);
  if (!checked || checked->boards[0].tags.size() != photo.board.tags.size()) {
    return state.SkipWithError("not all tags were found");
  }
  for (const SeenTag& tag : checked->boards[0].tags) {
    const auto corners = TagCorners(photo.board.tags[tag.index]);
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::Vector3d point(corners[k].x(), corners[k].y(), 0.0);
      const auto truth = Project(photo.camera, photo.cam_from_board * point);
      if (!tag.refined || (tag.refined->corners_px[k] - *truth).norm() > kMaxError_px) {
        return state.SkipWithError("a corner is wrong");
      }
    }
  }
  for (auto _ : state) benchmark::DoNotOptimize(finder->Find(photo.image));
}

void LibraryAprilTag(benchmark::State& state, const Photo& (*the_photo)(), float decimate) {
  const cv::Mat image = the_photo().image;
  apriltag_family_t* family = tag36h11_create();
  apriltag_detector_t* detector = apriltag_detector_create();
  apriltag_detector_add_family(detector, family);
  detector->quad_decimate = decimate;
  image_u8_t view = {image.cols, image.rows, static_cast<std::int32_t>(image.step), image.data};
  int count = 0;
  for (auto _ : state) {
    zarray_t* found = apriltag_detector_detect(detector, &view);
    count = zarray_size(found);
    apriltag_detections_destroy(found);
  }
  if (count != 4) state.SkipWithError("not all tags were found");
  apriltag_detector_destroy(detector);
  tag36h11_destroy(family);
}

void LibraryAruco(benchmark::State& state, const Photo& (*the_photo)(),
                  cv::aruco::CornerRefineMethod refine) {
  cv::setNumThreads(1);
  const cv::Mat image = the_photo().image;
  const cv::aruco::Dictionary dictionary =
      PredefinedArucoDictionary(cv::aruco::DICT_APRILTAG_36h11);
  cv::aruco::DetectorParameters parameters = ArucoParameters();
  parameters.cornerRefinementMethod = refine;
  std::size_t count = 0;
  for (auto _ : state) count = DetectAruco(image, dictionary, parameters).size();
  if (count != 4) state.SkipWithError("not all tags were found");
}

BENCHMARK_CAPTURE(LibraryAprilTag, tags_apriltag_library_decimate_1, ThePhoto, 1.0F)
    ->Name("tags_1280x720/apriltag_library_decimate_1/4")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(LibraryAprilTag, tags_apriltag_library_decimate_2, ThePhoto, 2.0F)
    ->Name("tags_1280x720/apriltag_library_decimate_2/4")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Ours, tags_sextant_apriltag, ThePhoto, "apriltag")
    ->Name("tags_1280x720/sextant_apriltag/4")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Ours, tags_sextant_apriltag_decimate_1, ThePhoto, "apriltag(decimate=1)")
    ->Name("tags_1280x720/sextant_apriltag_decimate_1/4")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Ours, tags_sextant_apriltag_decimate_2, ThePhoto, "apriltag(decimate=2)")
    ->Name("tags_1280x720/sextant_apriltag_decimate_2/4")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(LibraryAruco, tags_opencv_library_none, ThePhoto, cv::aruco::CORNER_REFINE_NONE)
    ->Name("tags_1280x720/opencv_library_none/4")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(LibraryAruco, tags_opencv_library_subpix, ThePhoto,
                  cv::aruco::CORNER_REFINE_SUBPIX)
    ->Name("tags_1280x720/opencv_library_subpix/4")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(LibraryAruco, tags_opencv_library_contour, ThePhoto,
                  cv::aruco::CORNER_REFINE_CONTOUR)
    ->Name("tags_1280x720/opencv_library_contour/4")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Ours, tags_sextant_aruco, ThePhoto, "aruco")
    ->Name("tags_1280x720/sextant_aruco/4")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Ours, tags_sextant_aruco_decimate_1, ThePhoto, "aruco(decimate=1)")
    ->Name("tags_1280x720/sextant_aruco_decimate_1/4")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Ours, tags_sextant_aruco_contour, ThePhoto, "aruco(refine=contour)")
    ->Name("tags_1280x720/sextant_aruco_contour/4")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Ours, tags_sextant_aruco_subpix, ThePhoto, "aruco(refine=subpix)")
    ->Name("tags_1280x720/sextant_aruco_subpix/4")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(LibraryAprilTag, textured_tags_apriltag_library_decimate_1, TheTexturedPhoto,
                  1.0F)
    ->Name("textured_tags_1280x720/apriltag_library_decimate_1/4")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(LibraryAprilTag, textured_tags_apriltag_library_decimate_2, TheTexturedPhoto,
                  2.0F)
    ->Name("textured_tags_1280x720/apriltag_library_decimate_2/4")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Ours, textured_tags_sextant_apriltag, TheTexturedPhoto, "apriltag")
    ->Name("textured_tags_1280x720/sextant_apriltag/4")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Ours, textured_tags_sextant_apriltag_decimate_1, TheTexturedPhoto,
                  "apriltag(decimate=1)")
    ->Name("textured_tags_1280x720/sextant_apriltag_decimate_1/4")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(LibraryAruco, textured_tags_opencv_library_none, TheTexturedPhoto,
                  cv::aruco::CORNER_REFINE_NONE)
    ->Name("textured_tags_1280x720/opencv_library_none/4")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Ours, textured_tags_sextant_aruco, TheTexturedPhoto, "aruco")
    ->Name("textured_tags_1280x720/sextant_aruco/4")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Ours, textured_tags_sextant_aruco_decimate_1, TheTexturedPhoto,
                  "aruco(decimate=1)")
    ->Name("textured_tags_1280x720/sextant_aruco_decimate_1/4")
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sextant

BENCHMARK_MAIN();
