#pragma once
#include <gtest/gtest.h>

#include <initializer_list>
#include <string>

namespace tuft::fe::test {

/// Runs `body` and expects Error with all `words` in its text, on one line.
template <class Error, class Body>
void expect_error(Body&& body, std::initializer_list<const char*> words) {
  try {
    body();
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Error& error) {
    const std::string text = error.what();
    for (const char* word : words)
      EXPECT_NE(text.find(word), std::string::npos) << "no '" << word << "' in: " << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  }
}

}  // namespace tuft::fe::test
