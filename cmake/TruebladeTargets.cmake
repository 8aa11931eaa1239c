# Helpers for the folder libraries: one call declares a library, so that warnings, includes and the export are
# the same everywhere and a folder's CMakeLists lists nothing but its sources and what it depends on.

add_library(trueblade_flags INTERFACE)
target_compile_options(trueblade_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast)
if(TRUEBLADE_WARNINGS_AS_ERRORS)
  target_compile_options(trueblade_flags INTERFACE -Werror)
endif()
if(TRUEBLADE_SANITIZE)
  target_compile_options(trueblade_flags INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=undefined
                                                   -fno-omit-frame-pointer)
  target_link_options(trueblade_flags INTERFACE -fsanitize=address,undefined)
  # Instrumented code confuses GCC's flow analysis (its manual says so); the other presets keep this warning.
  target_compile_options(trueblade_flags INTERFACE -Wno-maybe-uninitialized)
endif()
# One build, one result: the compiler may not contract a*b+c differently from place to place.
target_compile_options(trueblade_flags INTERFACE -ffp-contract=off)

# Eigen, OpenMesh and GoogleTest are most of what a compiler reads here, and they never change: precompiled once a target,
# they take a third of the build time off.
set(trueblade_stable_headers <Eigen/Core> <Eigen/Geometry> <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh> <algorithm>
                             <array> <functional> <memory> <optional> <span> <string> <vector>)

# trueblade_library(NAME SOURCES a.cpp ... PUBLIC deps ... PRIVATE deps ... [PRECOMPILED <header> ...])
function(trueblade_library NAME)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE;PRECOMPILED" ${ARGN})
  add_library(trueblade_${NAME} STATIC ${ARG_SOURCES})
  add_library(trueblade::${NAME} ALIAS trueblade_${NAME})
  set_target_properties(trueblade_${NAME} PROPERTIES EXPORT_NAME ${NAME} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(trueblade_${NAME} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                      $<INSTALL_INTERFACE:include/trueblade>)
  target_compile_features(trueblade_${NAME} PUBLIC cxx_std_20)
  target_link_libraries(trueblade_${NAME} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:trueblade_flags>)
  target_precompile_headers(trueblade_${NAME} PRIVATE ${trueblade_stable_headers} ${ARG_PRECOMPILED})
  set_property(GLOBAL APPEND PROPERTY TRUEBLADE_LIBRARIES trueblade_${NAME})
endfunction()

# trueblade_test(FOLDER SOURCES a_test.cpp ... LIBRARIES ...): one test program per folder.
function(trueblade_test NAME)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(${NAME}_test ${ARG_SOURCES})
  target_link_libraries(${NAME}_test PRIVATE ${ARG_LIBRARIES} GTest::gtest_main trueblade_flags)
  target_include_directories(${NAME}_test PRIVATE ${PROJECT_SOURCE_DIR})
  target_precompile_headers(${NAME}_test PRIVATE ${trueblade_stable_headers} <gtest/gtest.h>)
  # Real input lives beside the project and is not part of it; tests skip with a message where it is absent.
  target_compile_definitions(${NAME}_test PRIVATE TRUEBLADE_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                                                  TRUEBLADE_DATA_DIR="${PROJECT_SOURCE_DIR}/../shared/data")
  if(TRUEBLADE_SANITIZE)
    # Slow code: one process for the whole folder, so that a part that many tests share is built once.
    add_test(NAME ${NAME}_test COMMAND ${NAME}_test)
    set_tests_properties(${NAME}_test PROPERTIES TIMEOUT 1500
      ENVIRONMENT "LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/leaks_of_others.txt:print_suppressions=0")
  else()
    gtest_discover_tests(${NAME}_test DISCOVERY_TIMEOUT 120 PROPERTIES TIMEOUT 600)
  endif()
endfunction()
