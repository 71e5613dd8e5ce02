#include "pipeline/picture/picture.h"
#include <gtest/gtest.h>
TEST(Picture, Stub) {}
