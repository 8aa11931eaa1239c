// EXPECT_INPUT_ERROR(statement, "part of the message"): it throws InputError and says that.
#pragma once

#include <gtest/gtest.h>

#include "geometry/error.h"

#define EXPECT_INPUT_ERROR(statement, words)                                             \
  try {                                                                                  \
    statement;                                                                           \
    ADD_FAILURE() << "no InputError, expected one that says \"" << (words) << "\"";      \
  } catch (const ::trueblade::InputError& error) {                                       \
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what(); \
  }
