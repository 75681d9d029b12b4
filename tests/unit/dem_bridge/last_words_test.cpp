/// What is quoted of a program's output.
#include "dem_bridge/last_words.h"

#include <gtest/gtest.h>

namespace tuft::dem {
namespace {

TEST(LastWords, OfAnErrorAreItsFirstLine) {
  const std::string text = "Step 1\n  ERROR on proc 0: bad file\nERROR: and then\nLoop time\n";
  EXPECT_EQ(error_line(text), "ERROR on proc 0: bad file");
  EXPECT_EQ(telling_line(text), "ERROR on proc 0: bad file");
  EXPECT_EQ(error_line("ERROR: " + std::string(1000, 'x')).size(), 400u);
}

TEST(LastWords, OfNoErrorAreTheLastLineThatSaysSomething) {
  const std::string text = "one\n\texited on signal 9\n-----\n\n";
  EXPECT_EQ(error_line(text), "");
  EXPECT_EQ(telling_line(text), "exited on signal 9");
  EXPECT_EQ(telling_line("----\n \n"), "");
}

}  // namespace
}  // namespace tuft::dem
