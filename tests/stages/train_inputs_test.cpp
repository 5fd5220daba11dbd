#include "oraclegs/stages/train_inputs.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "depth/surfaces.h"
#include "oraclegs/core/files.h"
#include "oraclegs/networks/loader.h"
#include "run/fixtures.h"
#include "support/buffers.h"
#include "support/errors.h"
#include "support/event_recorder.h"
#include "support/network_files.h"
#include "support/temp_dir.h"

namespace oraclegs {
namespace {

constexpr int kSide = 24;

/// A gray square in the middle of a white picture, at inverse depth 0.5, of which the left half is confident.
struct Object {
  std::vector<LoadedView> photos;
  Geometry geometry;

  TrainingViews training() const { return TrainingViews(photos); }

  Object() {
    Camera camera{kSide, kSide, 20, 20, kSide / 2., kSide / 2., Eigen::Isometry3d::Identity()};
    LoadedView photo{"a.png", camera, {kSide, kSide, 3, {}}, {}};
    DepthMap map{"a.png", camera, {}, {}, {}};
    for (int i = 0; i < kSide * kSide; ++i) {
      const int x = i % kSide, y = i / kSide;
      const bool object = x >= 8 && x < 16 && y >= 8 && y < 16;
      photo.rgb.data.insert(photo.rgb.data.end(), 3, object ? 0.4f : 1.f);
      map.inv_depth.push_back(object ? 0.5f : 0.f);
      map.normals.emplace_back(0, 0, object ? -1 : 0);
      map.confidence.push_back(!object ? 0 : x < 12 ? 0.9f : 0.3f);
    }
    photos.push_back(std::move(photo));
    geometry.maps.push_back(std::move(map));
    geometry.gains.emplace_back(1.2f, 1.f, 0.8f);
  }
};

TEST(TrainInputs, MaskDepthByConfidenceAndSilhouette) {
  const Object object;
  const TrainView view = MakeTrainViews(object.training(), object.geometry, {}).front();
  const auto depth = [&](int y, int x) { return view.inv_depth[y * kSide + x]; };
  const auto mask = [&](int y, int x) { return view.depth_mask[y * kSide + x]; };
  EXPECT_EQ(depth(10, 9), 0.5f);
  EXPECT_NEAR(mask(10, 9), 0.9, 1e-6);
  EXPECT_EQ(mask(10, 14), 0) << "not confident";
  EXPECT_EQ(depth(2, 2), 0);
  EXPECT_EQ(mask(2, 2), 1) << "empty for certain";
  EXPECT_EQ(mask(10, 7), 0) << "too near the silhouette to be certain";
  EXPECT_FLOAT_EQ(view.exposure[0], 1.2f);
  EXPECT_FLOAT_EQ(view.exposure[10], 0.8f);
  EXPECT_FALSE(MakeTrainViews(object.training(), {}, {}).front().inv_depth.defined());
}

TEST(TrainInputs, ShowNothingBesideAMaskedObject) {
  Object object;
  object.photos[0].mask.assign(kSide * kSide, 0);
  for (int y = 7; y < 17; ++y) std::fill_n(object.photos[0].mask.begin() + y * kSide + 7, 10, 1);
  object.photos[0].mask[10 * kSide + 10] = 0;
  const ViewUse use{DepthLoss::kRelative, Background::kGray};
  const TrainView view = MakeTrainViews(object.training(), object.geometry, use).front();
  const auto pixel = [&](int y, int x) {
    const int64_t i = y * kSide + x;
    return std::array<float, 3>{view.image[3 * i], view.pixel_weight[i], view.alpha[i]};
  };
  EXPECT_THAT(pixel(2, 2), testing::ElementsAre(0.5f, 1, 0)) << "masked";
  EXPECT_THAT(pixel(7, 7), testing::ElementsAre(1.f, 1, 0)) << "used, though it is plain background";
  EXPECT_THAT(pixel(9, 9), testing::ElementsAre(0.4f, 1, 1));
  EXPECT_EQ(pixel(10, 10)[1], 0) << "masked within the object: unknown";
  EXPECT_EQ(view.depth_mask[2 * kSide + 2], 1) << "empty for certain";
  EXPECT_EQ(object.photos[0].rgb.data[0], 1) << "the photo itself stays";
  EXPECT_FALSE(MakeTrainViews(object.training(), object.geometry, {DepthLoss::kPaper}).front().alpha.defined());
  object.photos[0].mask.assign(kSide * kSide, 1);
  object.photos[0].mask[0] = 0;
  EXPECT_FALSE(MakeTrainViews(object.training(), object.geometry, use).front().alpha.defined()) << "a corner";
  object.photos[0].mask.clear();
  EXPECT_FALSE(MakeTrainViews(object.training(), object.geometry, use).front().alpha.defined());
}

TEST(TrainInputs, WeightANetworksDepthByItsConfidence) {
  Object object;
  object.geometry.maps[0].monocular = true;
  const TrainView view = MakeTrainViews(object.training(), object.geometry, {}).front();
  const auto mask = [&](int y, int x) { return view.depth_mask[y * kSide + x]; };
  EXPECT_NEAR(mask(10, 9), 0.9, 1e-6);
  EXPECT_NEAR(mask(10, 14), 0.3, 1e-6);
}

TEST(TrainInputs, MaskDepthByZeroAndOneForThePaper) {
  Object object;
  const auto masks = [&] {
    const TrainView view = MakeTrainViews(object.training(), object.geometry, {DepthLoss::kPaper}).front();
    return std::vector<float>{view.depth_mask[10 * kSide + 9], view.depth_mask[10 * kSide + 14],
                              view.depth_mask[2 * kSide + 2]};
  };
  EXPECT_THAT(masks(), testing::ElementsAre(1, 0, 0)) << "confident, not confident, nothing";
  object.geometry.maps[0].monocular = true;
  EXPECT_THAT(masks(), testing::ElementsAre(1, 1, 0)) << "a network's depth counts wherever the silhouette allows";
  object.geometry.maps[0].inv_depth[10 * kSide + 14] = 0, object.geometry.maps[0].confidence[10 * kSide + 14] = 0;
  EXPECT_THAT(masks(), testing::ElementsAre(1, 1, 0)) << "and beyond infinity";
  std::fill(object.geometry.maps[0].confidence.begin(), object.geometry.maps[0].confidence.end(), 0.f);
  EXPECT_THAT(masks(), testing::ElementsAre(0, 0, 0)) << "but not where it could not be aligned";
}

TEST(TrainInputs, SayWhatTheTrainingIsSettledFrom) {
  Object object;
  EXPECT_TRUE(EvidenceOf(object.training(), object.geometry).is_object);
  for (size_t i = 0; i < object.photos[0].rgb.data.size(); i += 2) object.photos[0].rgb.data[i] = 0;  // no plain border
  EXPECT_FALSE(EvidenceOf(object.training(), object.geometry).is_object);
  EXPECT_EQ(EvidenceOf(object.training(), {}).photos, 1u);
  Geometry geometry;
  EXPECT_EQ(EvidenceOf(TrainingViews({}), geometry).exposure_spread, 0);
  geometry.gains.assign(4, Eigen::Vector3f::Ones());
  EXPECT_EQ(EvidenceOf(TrainingViews({}), geometry).exposure_spread, 0);
  geometry.gains[1] = Eigen::Vector3f::Constant(1.5f);
  EXPECT_GT(EvidenceOf(TrainingViews({}), geometry).exposure_spread, kVariedExposure);
}

TEST(MeanSquaredConfidence, IsThatOfPixelsThatTeach) {
  std::vector<TrainView> proposals(2);
  proposals[0].pixel_weight = Buffer<float>::Full({4, 6}, 1.f);
  proposals[0].image = Buffer<float>::Full({4, 6, 3}, 1.f);
  proposals[1].pixel_weight = Buffer<float>::Full({4, 6}, 0.5f);
  proposals[1].image = Buffer<float>::Full({4, 6, 3}, 0.3f);
  EXPECT_NEAR(MeanSquaredConfidence(proposals, std::nullopt).value(), (1 + 0.25) / 2, 1e-12);
  EXPECT_NEAR(MeanSquaredConfidence(proposals, {{1, 1, 1}}).value(), 0.25, 1e-12) << "plain white teaches nothing";
  EXPECT_FALSE(MeanSquaredConfidence({proposals[0]}, {{1, 1, 1}}).has_value());
  EXPECT_FALSE(MeanSquaredConfidence({}, std::nullopt).has_value());
}

TEST(TrainInputs, SaveExposuresByName) {
  const auto json = ExposuresToJson({"a.png"}, {{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}});
  EXPECT_EQ(json.at("a.png").size(), 12u);
  EXPECT_EQ(json.at("a.png").at(7), 7);
}

TEST(TrainInputs, ReadExposuresBackInTheOrderOfNames) {
  const TempDir temp;
  const ExposureMap a = {1.5f, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, b = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -0.25f};
  WriteFileAtomically(temp / "exposures.json", ExposuresToJson({"a.png", "b.png"}, {a, b}).dump());
  EXPECT_EQ(ReadExposures(temp / "exposures.json", {"b.png", "a.png"}), (std::vector<ExposureMap>{b, a}));
  EXPECT_EQ(MessageOf<InputError>([&] { ReadExposures(temp / "exposures.json", {"c.png"}); }),
            (temp / "exposures.json").string() +
                ": holds no color map of c.png; delete it and run `oraclegs reconstruct` again");
  for (const char* text : {"", "[]", R"({"a.png": [1, 2]})", R"({"a.png": [1,2,3,4,5,6,7,8,9,10,11,"12"]})"}) {
    WriteFileAtomically(temp / "damaged.json", text);
    EXPECT_THROW(ReadExposures(temp / "damaged.json", {"a.png"}), InputError) << text;
  }
}

TEST(NetworkPseudoDepth, IsWhatTheNetworkSeesInTheRender) {
  SKIP_WITHOUT_NETWORKS();
  const TempDir temp;
  EventRecorder recorder;
  const auto file = WriteTinyDepthAnything(temp / "depth.safetensors");
  const Buffer<float> image = RandomUniform({30, 40, 3}, 3);
  const auto network = GetNetworks().LoadDepth(file, kCpu);
  const Buffer<float> expected = network->InverseDepth({40, 30, 3, {image.span().begin(), image.span().end()}});
  int asked = 0;
  const PseudoDepth depth = NetworkPseudoDepth(file, kCpu, recorder.AsListener());
  const Buffer<float> of_image = depth({}, image, [&](const DepthTarget& target) {
    ++asked;
    EXPECT_TRUE(SameBytes(target.inv_depth, expected));
    EXPECT_FALSE(target.mask.defined());
    return RandomNormal(target.inv_depth.shape(), 4);
  });
  EXPECT_EQ(asked, 1);
  EXPECT_EQ(of_image.shape(), image.shape());
  EXPECT_GT(Flat(of_image).abs().maxCoeff(), 0);
}

TEST(NetworkPseudoDepth, RefusesAFileThatIsNone) {
  SKIP_WITHOUT_NETWORKS();
  EXPECT_THROW(NetworkPseudoDepth("/nowhere/depth.safetensors", kCpu, Silent()), InputError);
}

/// Photos of a textured wall, whose depth is known.
class StereoPseudoDepthTest : public testing::Test {
 protected:
  StereoPseudoDepthTest() {
    for (const Camera& camera : Arc(4, 6)) {
      views.push_back(wall.Take(camera, fmt::format("p{}", views.size())));
      maps.push_back(TrueDepth(views.back(), wall, 0.9f));
    }
  }
  DepthTarget Ask(const Camera& camera) const {
    DepthTarget seen;
    const Buffer<float> image = Buffer<float>::Zeros({camera.height, camera.width, 3});
    const Buffer<float> of_image = StereoPseudoDepth(views, maps)(camera, image, [&](const DepthTarget& target) {
      seen = target;
      return Buffer<float>::Zeros(target.inv_depth.shape());
    });
    EXPECT_FALSE(of_image.defined());
    return seen;
  }

  TexturedPlane wall;
  std::vector<LoadedView> views;
  std::vector<DepthMap> maps;
};

TEST_F(StereoPseudoDepthTest, IsTheDepthOfTheSurfaceFromAnotherPlace) {
  const Camera between = CameraAt({0.2, 0, -4}, {0, 0, 0}, 96, 72);
  const DepthTarget target = Ask(between);
  int64_t right = 0, counted = 0;
  for (int y = 0; y < between.height; ++y) {
    for (int x = 0; x < between.width; ++x) {
      const int64_t i = int64_t{y} * between.width + x;
      if (target.mask[i] == 0) continue;
      ++counted;
      right += std::abs(target.inv_depth[i] * wall.DepthAt(between, x + 0.5, y + 0.5) - 1) < 0.02 ? 1 : 0;
    }
  }
  EXPECT_GT(counted, between.width * between.height / 2);
  EXPECT_GT(right, counted * 95 / 100);
}

TEST_F(StereoPseudoDepthTest, CountsNothingWhereNoDepthIsKnown) {
  for (DepthMap& map : maps) std::fill(map.confidence.begin(), map.confidence.end(), 0.f);
  EXPECT_EQ(Flat(Ask(views[0].camera).mask).maxCoeff(), 0);
}

TEST_F(StereoPseudoDepthTest, RefusesAMapOfNoView) {
  maps.push_back(maps[0]);
  EXPECT_THROW(StereoPseudoDepth(views, maps), ShapeError);
}

}  // namespace
}  // namespace oraclegs
