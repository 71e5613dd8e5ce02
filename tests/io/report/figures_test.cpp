// Figures of error as people read them, and when one of them is over its bound.
#include "io/report/figures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace cloudbake {
namespace {

std::string overBoundOf(const char* key, double value, double most, bool is_fit = false) {
  BakeFigures figures;
  figures.is_fit = is_fit;
  figureField(key).value(figures) = value;
  const FigureBound bound{&figureField(key), most};
  return overBound(figures, {&bound, 1});
}

// A bound is for the size of an error. A bias has a sign, and being too low is as wrong as being too high.
TEST(Figures, LinesHaveALabelAndAText) {
  EXPECT_EQ(figureLine("T", "rms {}", 2), "T              rms 2\n");
  EXPECT_EQ(figureLine("a label of many words", "rms {}", 2), "a label of many words rms 2\n");
}

TEST(Figures, ABoundHoldsForBothSigns) {
  size_t with_sign = 0;
  for (const FigureField& field : figureFields()) {
    EXPECT_NE(overBoundOf(field.key, 0.3, 0.25), "") << field.key;
    EXPECT_EQ(overBoundOf(field.key, 0.2, 0.25), "") << field.key;
    EXPECT_EQ(overBoundOf(field.key, 0.25, 0.25), "") << field.key << " is on its bound, not over it";
    if (!field.may_be_negative) continue;
    ++with_sign;
    EXPECT_EQ(overBoundOf(field.key, -0.3, 0.25), overBoundOf(field.key, 0.3, 0.25)) << field.key;
    EXPECT_EQ(overBoundOf(field.key, -0.2, 0.25), "") << field.key;
  }
  EXPECT_EQ(with_sign, 2U) << "the bias of the density and that of the transmittance";
}

TEST(Figures, ABoundSaysWhatIsOverIt) {
  EXPECT_EQ(overBoundOf("density_bias", -0.3, 0.25), "density is off by 30% bias, over 25%");
  EXPECT_EQ(overBoundOf("direction_rms_degrees", 12.34, 10), "direction is off by 12.3° rms, over 10°");
  EXPECT_EQ(overBoundOf("transmittance_rms", 0.0512, 0.05), "transmittance is off by 5.12% rms, over 5%");
}

TEST(Figures, TheFirstBoundThatIsExceededIsTold) {
  BakeFigures figures;
  figures.lobe.angle_median_degrees = 3;
  figures.lobe.density_bias = -0.5;
  const std::vector<FigureBound> bounds{
      {&figureField("direction_rms_degrees"), 1}, {&figureField("density_bias"), 0.25}, {&figureField("direction_median_degrees"), 1}};
  EXPECT_EQ(overBound(figures, bounds).find("density is off by 50% bias"), 0U);
  EXPECT_EQ(overBound(figures, bounds, "differs").find("density differs by 50% bias"), 0U);
  EXPECT_EQ(overBound(figures, {}), "");
}

// What cannot be measured keeps no bound. A fit has no direction and no density that could be judged.
TEST(Figures, UndefinedFiguresAndFits) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(overBoundOf("transmittance_rms", nan, 1), "transmittance is off by undefined rms, over 100%");
  for (const FigureField& field : figureFields()) {
    EXPECT_NE(overBoundOf(field.key, nan, 1), "") << field.key;
    EXPECT_EQ(overBoundOf(field.key, 2, 1, true).empty(), field.of_mean_lobe) << field.key;
    EXPECT_EQ(overBoundOf(field.key, nan, 1, true).empty(), field.of_mean_lobe) << field.key;
  }
}

}  // namespace
}  // namespace cloudbake
