#include "omnitag/camera/camera_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "camera/catadioptric_camera.h"
#include "camera/double_sphere_camera.h"
#include "camera/equidistant_camera.h"
#include "camera/equirectangular_camera.h"
#include "camera/eucm_camera.h"
#include "camera/ocam_camera.h"
#include "camera/unified_camera.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

constexpr char kSphere[] =
    "model: catadioptric\n"
    "image: {width: 500, height: 400}\n"
    "lens: {fx: 1234, fy: 1230.5, cx: 249.5, cy: 199.5}\n"
    "mirror:\n"
    "  profile: spherical\n"
    "  radius_of_curvature: 0.04\n"
    "  apex_distance: 0.21\n"
    "  rim_radius: 0.0375\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t position = text.find(from);
  EXPECT_NE(position, std::string::npos) << from;
  return text.replace(position, from.size(), to);
}

std::string sphereWith(const std::string& from, const std::string& to) {
  return replaced(kSphere, from, to);
}

std::string mirrorWith(const std::string& profile) {
  return sphereWith("profile: spherical\n  radius_of_curvature: 0.04", profile);
}

double sagAt(const std::string& text, double rho) {
  const auto camera =
      std::dynamic_pointer_cast<const CatadioptricCamera>(parseCamera(text, "camera.yaml"));
  EXPECT_TRUE(camera);
  return camera->mirror().profile.at(rho).sag;
}

TEST(CameraFile, describesLensAndMirror) {
  const auto camera =
      std::dynamic_pointer_cast<const CatadioptricCamera>(parseCamera(kSphere, "camera.yaml"));
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->imageSize().width, 500);
  EXPECT_EQ(camera->imageSize().height, 400);
  EXPECT_EQ(camera->imagePlane().affine()(0, 0), 1234.0);
  EXPECT_EQ(camera->imagePlane().affine()(1, 1), 1230.5);
  EXPECT_EQ(camera->imagePlane().affine()(0, 1), 0.0);
  EXPECT_EQ(camera->imagePlane().principalPoint(), Eigen::Vector2d(249.5, 199.5));
  EXPECT_FALSE(camera->imagePlane().isDistorted());
  EXPECT_EQ(camera->mirror().apex_distance, 0.21);
  EXPECT_EQ(camera->mirror().rim_radius, 0.0375);
  EXPECT_EQ(camera->mirror().housing_radius, 0.0);
}

TEST(CameraFile, readsEveryProfile) {
  EXPECT_NEAR(sagAt(kSphere, 0.024), 0.04 - 0.032, 1e-15);
  EXPECT_NEAR(sagAt(sphereWith("spherical", "spherical\n  conic_constant: 0"), 0.024), 0.008,
              1e-15);
  EXPECT_NEAR(sagAt(sphereWith("spherical", "parabolic"), 0.02), 0.005, 1e-15);
  EXPECT_NEAR(sagAt(sphereWith("spherical", "parabolic\n  conic_constant: -1.0"), 0.02), 0.005,
              1e-15);
  // rho^2 - 3 s^2 - 0.08 s = 0
  EXPECT_NEAR(sagAt(sphereWith("spherical", "hyperbolic\n  conic_constant: -4"), 0.02),
              (-0.08 + std::sqrt(0.0064 + 12.0 * 0.0004)) / 6.0, 1e-15);
  EXPECT_NEAR(sagAt(sphereWith("spherical",
                               "aspheric\n  conic_constant: -1\n  coefficients: [100, -20000]"),
                    0.02),
              0.005 + 100.0 * 1.6e-7 - 2e4 * 6.4e-11, 1e-15);
  EXPECT_NEAR(sagAt(mirrorWith("profile: tabulated\n"
                               "  samples: [[0, 0], [0.01, 0.001], [0.02, 0.004], [0.04, 0.016]]"),
                    0.03),
              0.009, 1e-15);
}

TEST(CameraFile, readsDistortionAndHousing) {
  const auto camera = std::dynamic_pointer_cast<const CatadioptricCamera>(
      parseCamera(sphereWith("199.5}",
                             "199.5, distortion: [-0.1, 0, 0.001, 0, 2], "
                             "housing_radius: 0.03}"),
                  "camera.yaml"));
  ASSERT_TRUE(camera);
  const ImagePlane::Distortion expected{-0.1, 0.0, 0.001, 0.0, 2.0};
  EXPECT_EQ(camera->imagePlane().distortion(), expected);
  EXPECT_EQ(camera->mirror().housing_radius, 0.03);
  EXPECT_GT(camera->minRadius(), 0.0);
}

TEST(CameraFile, takesIntegersForReals) {
  const auto camera = parseCamera(
      "model: catadioptric\n"
      "image: {width: 500, height: 400}\n"
      "lens: {fx: 1000, fy: 1000, cx: 250, cy: 200, distortion: [0, 0, 0, 0, 0]}\n"
      "mirror: {profile: hyperbolic, radius_of_curvature: 1, conic_constant: -2, "
      "apex_distance: 5, rim_radius: 1}\n",
      "camera.yaml");
  EXPECT_EQ(camera->imagePlane().principalPoint(), Eigen::Vector2d(250.0, 200.0));
}

constexpr char kEquidistant[] =
    "model: equidistant\n"
    "image: {width: 500, height: 400}\n"
    "lens: {fx: 146, fy: 145.5, cx: 249.5, cy: 199.5}\n"
    "distortion: [-0.01, 0.002, 0, 0.0001]\n"
    "max_angle: 1.66\n";

constexpr char kUnified[] =
    "model: unified\n"
    "image: {width: 500, height: 500}\n"
    "lens: {fx: 260, fy: 261, cx: 249.5, cy: 250, skew: 0.5}\n"
    "xi: 1.1\n"
    "distortion: [-0.05, 0.01, 0.001, -0.002]\n";

constexpr char kDoubleSphere[] =
    "model: double_sphere\n"
    "image: {width: 500, height: 400}\n"
    "lens: {fx: 150, fy: 151, cx: 249.5, cy: 199.5}\n"
    "xi: -0.2\n"
    "alpha: 0.6\n";

constexpr char kEucm[] =
    "model: eucm\n"
    "image: {width: 500, height: 400}\n"
    "lens: {fx: 210, fy: 211, cx: 249.5, cy: 199.5, skew: 0.25}\n"
    "alpha: 0.6\n"
    "beta: 1.1\n"
    "max_angle: 1.5\n";

constexpr char kOcam[] =
    "model: ocam\n"
    "calibration_file: calib_results.txt\n";

constexpr char kCalibration[] =
    "# direct\n5 -289.5569 0 1.538894e-03 -3.14032e-06 7.206996e-09\n# inverse\n2 434.4 226.0\n"
    "# center\n390.9 423.7\n# affine\n0.999 -0.0003 -0.0001\n# size\n800 848\n";

/// The path of a camera file with this text, beside a calib_results.txt.
std::string writtenCamera(const std::string& text) {
  const std::string folder = testing::TempDir();
  std::ofstream(folder + "calib_results.txt") << kCalibration;
  std::ofstream(folder + "central_camera_file_test.yaml") << text;
  return folder + "central_camera_file_test.yaml";
}

template <typename Model>
std::shared_ptr<const Model> loaded(const std::string& text) {
  return std::dynamic_pointer_cast<const Model>(loadCamera(writtenCamera(text)));
}

TEST(CameraFile, describesAnEquidistantLens) {
  const auto camera = loaded<EquidistantCamera>(kEquidistant);
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->imageSize().height, 400);
  EXPECT_EQ(camera->imagePlane().affine()(1, 1), 145.5);
  EXPECT_EQ(camera->imagePlane().principalPoint(), Eigen::Vector2d(249.5, 199.5));
  EXPECT_EQ(camera->coefficients(), (EquidistantCamera::Coefficients{-0.01, 0.002, 0.0, 0.0001}));
  EXPECT_EQ(camera->maxAngle(), 1.66);
  EXPECT_FALSE(camera->throughMirror());
}

TEST(CameraFile, describesAUnifiedCamera) {
  const auto camera = loaded<UnifiedCamera>(kUnified);
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->xi(), 1.1);
  EXPECT_EQ(camera->imagePlane().affine()(0, 1), 0.5);
  EXPECT_EQ(camera->imagePlane().distortion(),
            (ImagePlane::Distortion{-0.05, 0.01, 0.001, -0.002, 0.0}));
  EXPECT_TRUE(
      loaded<UnifiedCamera>(std::string(kUnified) + "through_mirror: true\n")->throughMirror());
}

TEST(CameraFile, describesAPinhole) {
  const std::string text =
      "model: pinhole\n"
      "image: {width: 500, height: 400}\n"
      "lens: {fx: 400, fy: 401, cx: 249.5, cy: 199.5}\n";
  const auto plain = loaded<UnifiedCamera>(text);
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->xi(), 0.0);
  EXPECT_FALSE(plain->imagePlane().isDistorted());
  const auto four = loaded<UnifiedCamera>(text + "distortion: [-0.1, 0.01, 0.001, -0.002]\n");
  EXPECT_EQ(four->imagePlane().distortion(),
            (ImagePlane::Distortion{-0.1, 0.01, 0.001, -0.002, 0.0}));
  const auto five = loaded<UnifiedCamera>(text + "distortion: [-0.1, 0.01, 0.001, -0.002, 0.3]\n");
  EXPECT_EQ(five->imagePlane().distortion()[4], 0.3);
}

TEST(CameraFile, describesSpheresAndEllipsoids) {
  const auto spheres = loaded<DoubleSphereCamera>(kDoubleSphere);
  ASSERT_TRUE(spheres);
  EXPECT_EQ(spheres->parameters().xi, -0.2);
  EXPECT_EQ(spheres->parameters().alpha, 0.6);
  EXPECT_EQ(spheres->imagePlane().affine()(1, 1), 151.0);
  const auto ellipsoid = loaded<EucmCamera>(kEucm);
  ASSERT_TRUE(ellipsoid);
  EXPECT_EQ(ellipsoid->parameters().alpha, 0.6);
  EXPECT_EQ(ellipsoid->parameters().beta, 1.1);
  EXPECT_EQ(ellipsoid->imagePlane().affine()(0, 1), 0.25);
  EXPECT_EQ(ellipsoid->maxAngle(), 1.5);
}

TEST(CameraFile, describesAPanorama) {
  const auto camera = loaded<EquirectangularCamera>(
      "model: equirectangular\nimage: {width: 1000, height: 500}\nuncertainty: none\n");
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->imageSize().width, 1000);
  EXPECT_TRUE(camera->uncertainty().isNone());
}

TEST(CameraFile, findsTheToolboxsFileBesideIt) {
  const auto camera = loaded<OcamCamera>(kOcam);
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->imageSize().width, 848);
  EXPECT_EQ(camera->imagePlane().principalPoint(), Eigen::Vector2d(423.7, 390.9));
  EXPECT_EQ(loaded<OcamCamera>(std::string(kOcam) + "max_angle: 1.2\n")->maxAngle(), 1.2);
  const std::string absolute = testing::TempDir() + "calib_results.txt";
  EXPECT_TRUE(loaded<OcamCamera>("model: ocam\ncalibration_file: " + absolute + "\n"));
}

TEST(CameraFile, namesTheToolboxsFileWhereThatIsWrong) {
  const auto refusal = [](const std::string& calibration) -> std::string {
    const std::string path = writtenCamera(kOcam);
    std::ofstream(testing::TempDir() + "calib_results.txt") << calibration;
    try {
      loadCamera(path);
    } catch (const InputError& error) {
      return std::string(error.what()).substr(testing::TempDir().size());
    }
    return "";
  };
  const std::string camera = "central_camera_file_test.yaml";
  EXPECT_EQ(refusal("3 -280 zero"),
            camera + ":2: calibration_file: " + testing::TempDir() +
                "calib_results.txt:1: coefficient a1: expected a number, found 'zero'");
  EXPECT_EQ(refusal(replaced(kCalibration, "-289.5569", "289.5569")).find(camera + ": calibration"),
            0U);
}

TEST(CameraFile, saysHowFarItMayBeOff) {
  const auto uncertaintyWith = [](const std::string& text) {
    const std::string image = "image: {width: 500, height: 400}\n";
    return parseCamera(sphereWith(image, image + text), "camera.yaml")->uncertainty();
  };
  // Half a pixel where the image is 500 pixels high.
  const CameraUncertainty usual = uncertaintyWith("");
  for (const double mode : {usual.principal_point, usual.scale, usual.tilt, usual.rim}) {
    EXPECT_DOUBLE_EQ(mode, 0.4);
  }
  EXPECT_TRUE(uncertaintyWith("uncertainty: none\n").isNone());
  const CameraUncertainty stated = uncertaintyWith("uncertainty: {principal_point: 0.1, rim: 2}\n");
  EXPECT_EQ(stated.principal_point, 0.1);
  EXPECT_EQ(stated.scale, 0.0);
  EXPECT_EQ(stated.tilt, 0.0);
  EXPECT_EQ(stated.rim, 2.0);
  for (const std::string bad : {"uncertainty: some\n", "uncertainty: {scale: -1}\n",
                                "uncertainty: {centre: 1}\n", "uncertainty: [1, 2]\n"}) {
    EXPECT_THROW(uncertaintyWith(bad), InputError) << bad;
  }
}

TEST(CameraFile, isWhatTheDocumentationShows) {
  std::ifstream document(PACKAGE_DIR "/doc/camera_models.md");
  const std::string origin = writtenCamera(kOcam);
  std::set<std::string> profiles;
  std::set<std::string> models;
  std::string line;
  while (std::getline(document, line)) {
    if (line != "```yaml") continue;
    std::string example;
    while (std::getline(document, line) && line != "```") {
      example += line + "\n";
      if (line.find("profile: ") != std::string::npos) profiles.insert(line);
      if (line.find("model: ") == 0) models.insert(line);
    }
    EXPECT_NO_THROW(parseCamera(example, origin)) << example;
  }
  EXPECT_EQ(profiles.size(), 5u);
  EXPECT_EQ(models.size(), 8u);
}

TEST(CameraFile, saysWhetherItsImagesMayBeScaled) {
  EXPECT_FALSE(parseCamera(kEquidistant, "camera.yaml")->scalesToImage());
  for (const std::string& text : {std::string(kSphere), std::string(kEquidistant),
                                  std::string(kUnified), std::string(kEucm)}) {
    EXPECT_TRUE(parseCamera(text + "scale_to_image: true\n", "camera.yaml")->scalesToImage());
  }
  EXPECT_THROW(parseCamera(std::string(kEucm) + "scale_to_image: 2\n", "camera.yaml"), InputError);
}

struct Refusal {
  std::string name;
  std::string text;
  std::vector<std::string> fragments;
};

void PrintTo(const Refusal& refusal, std::ostream* out) { *out << refusal.name; }

class BadCameraFile : public testing::TestWithParam<Refusal> {};

TEST_P(BadCameraFile, isRefusedInOneLineThatTellsWhy) {
  std::string message;
  try {
    parseCamera(GetParam().text, "camera.yaml");
  } catch (const InputError& error) {
    message = error.what();
  }
  EXPECT_EQ(message.find("camera.yaml"), 0u) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  for (const std::string& fragment : GetParam().fragments) {
    EXPECT_NE(message.find(fragment), std::string::npos) << message << "\n lacks: " << fragment;
  }
  for (const std::string once : {"expected", "found", "camera.yaml"}) {
    EXPECT_EQ(message.find(once), message.rfind(once)) << "twice '" << once << "': " << message;
  }
}

Refusal badRadius(const std::string& name, const std::string& value) {
  return {
      name,
      sphereWith("0.04", value),
      {"camera.yaml:6: mirror.radius_of_curvature: expected a number > 0, found '" + value + "'"}};
}

Refusal badTable(const std::string& name, const std::string& samples,
                 const std::vector<std::string>& fragments) {
  return {name, mirrorWith("profile: tabulated\n  samples: " + samples), fragments};
}

std::vector<Refusal> refusals() {
  const auto lensWith = [](const std::string& more) {
    return sphereWith("199.5}", "199.5, " + more + "}");
  };
  return {
      {"MissingKey",
       sphereWith("  radius_of_curvature: 0.04\n", ""),
       {"camera.yaml:5: mirror.radius_of_curvature: expected a number > 0, found nothing"}},
      {"MissingMapping",
       sphereWith("image: {width: 500, height: 400}\n", ""),
       {"camera.yaml:1: image: expected a mapping of keys, found nothing"}},
      {"MissingProfile", sphereWith("  profile: spherical\n", ""), {"mirror.profile: expected"}},
      {"MissingConicConstant",
       sphereWith("spherical", "hyperbolic"),
       {"camera.yaml:5: mirror.conic_constant: expected a number, found nothing"}},
      {"EmptyValue", sphereWith("0.04", ""), {"mirror.radius_of_curvature: expected a number > 0"}},
      {"UnknownKey",
       sphereWith("rim_radius", "rim"),
       {"camera.yaml:8: mirror.rim: unknown key", "rim_radius"}},
      {"UnknownKeyAbove",
       sphereWith("image:", "colour: red\nimage:"),
       {"camera.yaml:2: colour: unknown key", "model, image, lens, mirror"}},
      {"DuplicateKey",
       sphereWith("  rim_radius", "  apex_distance: 1\n  rim_radius"),
       {"camera.yaml:8: mirror.apex_distance: expected once, found again"}},
      badRadius("Word", "forty"),
      badRadius("NotANumber", ".nan"),
      badRadius("Infinite", ".inf"),
      badRadius("TooLargeForANumber", "1e400"),
      badRadius("Negative", "-0.04"),
      badRadius("Zero", "0"),
      {"NumberOfPixelsNotInteger",
       sphereWith("500", "500.5"),
       {"camera.yaml:2: image.width: expected an integer >= 1", "found '500.5'"}},
      {"NoPixels", sphereWith("500", "0"), {"image.width: expected an integer >= 1", "found '0'"}},
      {"UnknownModel",
       sphereWith("catadioptric", "spherical"),
       {"camera.yaml:1: model: expected one of catadioptric, equidistant, unified, pinhole, "
        "double_sphere, eucm, ocam, equirectangular, found 'spherical'"}},
      {"EquidistantDistortionTooShort",
       replaced(kEquidistant, ", 0.0001]", "]"),
       {"camera.yaml:4: distortion: expected a list of 4 numbers, found a list of 3"}},
      {"EquidistantWithADistortionOfItsLens",
       replaced(kEquidistant, "199.5}", "199.5, distortion: [0]}"),
       {"camera.yaml:3: lens.distortion: unknown key"}},
      {"EquidistantThatFolds",
       replaced(kEquidistant, "-0.01", "-0.5"),
       {"camera.yaml: distortion: expected", "up to max_angle, 1.66 rad", "found one that folds"}},
      {"EquidistantThatNeverGrows",
       replaced(replaced(kEquidistant, "max_angle: 1.66\n", ""), "[-0.01", "[-1e300"),
       {"camera.yaml: distortion: expected", "found one that folds the image at 0 rad"}},
      {"MaxAngleAllAround",
       replaced(kEquidistant, "1.66", "3.2"),
       {"camera.yaml:5: max_angle: expected a number > 0 and <= 3.12, found '3.2'"}},
      {"NoXi",
       replaced(kUnified, "xi: 1.1\n", ""),
       {"camera.yaml:1: xi: expected a number >= 0, found nothing"}},
      {"UnifiedBeyondItsFold",
       std::string(kUnified) + "max_angle: 2.8\n",
       {"camera.yaml: xi: expected", "max_angle, 2.8 rad", "folds the image at 2.7"}},
      {"UnifiedThroughMaybe",
       std::string(kUnified) + "through_mirror: 3\n",
       {"camera.yaml:6: through_mirror: expected", "found '3'"}},
      {"PinholeDistortionTooLong",
       replaced(replaced(kEquidistant, "equidistant", "pinhole"), "0.0001", "0, 0, 0.0001"),
       {"camera.yaml:4: distortion: expected a list of 4 or 5 numbers, found a list of 6"}},
      {"PinholeBeyondNinetyDegrees",
       replaced(kEquidistant, "equidistant", "pinhole"),
       {"camera.yaml: xi: expected", "max_angle, 1.66 rad"}},
      {"DoubleSphereWithoutXi",
       replaced(kDoubleSphere, "xi: -0.2\n", ""),
       {"camera.yaml:1: xi: expected a number > -1, found nothing"}},
      {"DoubleSphereOutOfItsDomain",
       replaced(kDoubleSphere, "alpha: 0.6", "alpha: 1.01"),
       {"camera.yaml:5: alpha: expected a number >= 0 and <= 1, found '1.01'"}},
      {"DoubleSphereBeyondItsFold",
       std::string(kDoubleSphere) + "max_angle: 3\n",
       {"camera.yaml: xi, alpha: expected an image", "max_angle, 3 rad", "found one that folds"}},
      {"EucmWithoutBeta",
       replaced(kEucm, "beta: 1.1\n", ""),
       {"camera.yaml:1: beta: expected a number > 0, found nothing"}},
      {"EucmOutOfItsDomain",
       replaced(kEucm, "beta: 1.1", "beta: 0"),
       {"camera.yaml:5: beta: expected a number > 0, found '0'"}},
      {"EquirectangularWithALens",
       replaced(kEucm, "eucm", "equirectangular"),
       {"camera.yaml:3: lens: unknown key; expected one of: model, image, uncertainty, "
        "scale_to_image"}},
      {"OcamWithoutItsFile",
       "model: ocam\ncalibration_file: no/such.txt\n",
       {"camera.yaml:2: calibration_file: no/such.txt: expected a readable file, found none"}},
      {"OcamWithALineBreakInThePath",
       "model: ocam\ncalibration_file: \"a\\nb\"\n",
       {"camera.yaml:2: calibration_file: expected the path of a file, found 'a b'"}},
      {"OcamWithAnImage",
       std::string(kOcam) + "image: {width: 3, height: 3}\n",
       {"camera.yaml:3: image: unknown key"}},
      {"OcamWithAShortCentre",
       "model: ocam\nimage: {width: 9, height: 9}\ncalibration: {polynomial: [-3], center: [4], "
       "affine: [1, 0, 0]}\n",
       {"camera.yaml:3: calibration.center: expected a list of 2 numbers"}},
      {"OcamWithTwoCalibrations",
       std::string(kOcam) + "calibration: {polynomial: [-3]}\n",
       {"camera.yaml:2: calibration_file: unknown key"}},
      {"UnknownProfile",
       sphereWith("spherical", "round"),
       {"camera.yaml:5: mirror.profile: expected one of spherical, parabolic, hyperbolic, "
        "aspheric, tabulated, found 'round'"}},
      {"ProfileIsAList",
       sphereWith("spherical", "[spherical]"),
       {"camera.yaml:5: mirror.profile: expected a text, found a list of 1"}},
      {"SphereWithAnotherConicConstant",
       sphereWith("spherical", "spherical\n  conic_constant: -1"),
       {"camera.yaml:6: mirror.conic_constant: expected 0", "spherical", "found '-1'"}},
      {"ParabolaWithAnotherConicConstant",
       sphereWith("spherical", "parabolic\n  conic_constant: 0"),
       {"camera.yaml:6: mirror.conic_constant: expected -1", "parabolic", "found '0'"}},
      {"HyperbolaWithAnotherConicConstant",
       sphereWith("spherical", "hyperbolic\n  conic_constant: -1"),
       {"camera.yaml:6: mirror.conic_constant: expected a number < -1", "found '-1'"}},
      {"CoefficientsOfASphere",
       sphereWith("spherical", "spherical\n  coefficients: [1, 2]"),
       {"camera.yaml:6: mirror.coefficients: expected none", "found a list of 2"}},
      {"CoefficientIsAWord",
       sphereWith("spherical", "aspheric\n  conic_constant: 0\n  coefficients: [1, a6]"),
       {"camera.yaml:7: mirror.coefficients: expected a list of numbers, found 'a6'"}},
      {"RimBeyondTheSphere",
       sphereWith("0.0375", "0.05"),
       {"camera.yaml: mirror.rim_radius: expected", "to 0.04", "found 0.05"}},
      {"RimHiddenFromTheLens",
       sphereWith("0.21", "0.021"),
       {"camera.yaml: mirror.rim_radius: expected at most 0.0301", "found 0.0375"}},
      {"RaysThatCross",
       sphereWith("spherical", "aspheric\n  conic_constant: 0\n  coefficients: [-30000]"),
       {"camera.yaml: mirror: expected a convex profile", "found rays that cross at rho 0.0"}},
      badTable("TableTooShort", "[[0, 0], [0.02, 0.004], [0.04, 0.02]]",
               {"camera.yaml:6: mirror.samples: expected at least 4 samples [rho, sag], found 3"}),
      badTable("TableNotIncreasing", "[[0, 0], [0.02, 0.004], [0.02, 0.005], [0.04, 0.02]]",
               {"camera.yaml:6: mirror.samples: expected", "found [0.02, 0.005]"}),
      badTable("TableRowTooShort", "\n  - [0, 0]\n  - [0.02]\n  - [0.03, 1]\n  - [0.04, 2]",
               {"camera.yaml:8: mirror.samples[1]: expected a list of 2 numbers, found a list of "
                "1"}),
      badTable("TableWithAWord", "\n  - [0, 0]\n  - [0.02, x]\n  - [0.03, 1]\n  - [0.04, 2]",
               {"camera.yaml:8: mirror.samples[1]: expected a list of 2 numbers, found 'x'"}),
      badTable("TableIsANumber", "7", {"camera.yaml:6: mirror.samples: expected a list", "'7'"}),
      badTable("TableEndsBeforeTheRim", "[[0, 0], [0.01, 0.001], [0.02, 0.004], [0.03, 0.009]]",
               {"camera.yaml: mirror.rim_radius: expected", "to 0.03", "found 0.0375"}),
      badTable("ConcaveTable", "[[0, 0], [0.01, -0.001], [0.02, -0.004], [0.04, -0.016]]",
               {"camera.yaml: mirror: expected a convex profile"}),
      {"DistortionTooShort",
       lensWith("distortion: [0.1, 0]"),
       {"camera.yaml:3: lens.distortion: expected a list of 5 numbers, found a list of 2"}},
      {"DistortionThatFolds",
       lensWith("distortion: [-50, 0, 0, 0, 0]"),
       {"camera.yaml: lens.distortion: expected", "found one that folds"}},
      {"NegativeHousing",
       lensWith("housing_radius: -0.01"),
       {"camera.yaml:3: lens.housing_radius: expected a number >= 0, found '-0.01'"}},
      {"HousingThatFillsTheView",
       replaced(lensWith("housing_radius: 0.5"), "0.04\n", "0.4\n"),
       {"camera.yaml: lens.housing_radius: expected less", "found 0.5"}},
      {"NotYaml", "model: [catadioptric\nimage: 3", {"camera.yaml:", "cannot be parsed as YAML"}},
      {"Empty", "", {"expected a mapping of keys, found an empty value"}},
      {"AList", "- model\n- image\n", {"camera.yaml:1: expected a mapping", "found a list of 2"}},
      {"AWord", "catadioptric", {"camera.yaml:1: expected a mapping", "found 'catadioptric'"}},
      {"MirrorIsAList",
       replaced(kSphere, "mirror:\n  profile: spherical\n", "mirror: [1]\nother:\n"),
       {"other: unknown key"}},
      {"LensIsANumber",
       "model: catadioptric\nlens: 3\n",
       {"camera.yaml:2: lens: expected a mapping of keys, found '3'"}},
  };
}

INSTANTIATE_TEST_SUITE_P(, BadCameraFile, testing::ValuesIn(refusals()),
                         [](const auto& info) { return info.param.name; });

std::string refusalOfFile(const std::string& path) {
  try {
    loadCamera(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(CameraFile, isNamedWhereItCannotBeRead) {
  EXPECT_EQ(refusalOfFile("no/such/camera.yaml"),
            "no/such/camera.yaml: expected a readable file, found none");
  EXPECT_EQ(refusalOfFile(testing::TempDir()),
            testing::TempDir() + ": expected a readable file, found a directory");
}

TEST(CameraFile, isReadFromDisk) {
  const std::string path = testing::TempDir() + "camera_file_test.yaml";
  std::ofstream(path) << kSphere;
  EXPECT_EQ(loadCamera(path)->imageSize().width, 500);
  std::ofstream(path) << "";
  EXPECT_EQ(refusalOfFile(path), path + ": expected a mapping of keys, found an empty value");
  std::remove(path.c_str());
}

}  // namespace
}  // namespace omnitag
