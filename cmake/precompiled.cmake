# Headers that nearly every file includes, read once: a third of the time that files of this size compile. `make run`,
# `make test` and CI ask for them. They are other people's alone, so that none of ours is compiled again for them. Each
# file still includes what it uses: tools/check-includes.sh, clang-tidy and the nightly builds read it without them.
option(SPARSHA_PRECOMPILE "Precompile the headers of the standard library, Eigen and fmt" OFF)

set(SPARSHA_PRECOMPILED_HEADERS
  <algorithm> <array> <atomic> <bit> <charconv> <chrono> <cmath> <condition_variable> <cstddef> <cstdint> <cstdlib> <cstring>
  <deque> <exception> <filesystem> <fstream> <functional> <limits> <map> <memory> <mutex> <numbers> <numeric> <optional>
  <set> <span> <sstream> <stdexcept> <string> <string_view> <system_error> <thread> <tuple> <type_traits> <unordered_map>
  <utility> <variant> <vector> <Eigen/Core> <Eigen/Eigenvalues> <Eigen/Geometry> <Eigen/LU> <fmt/format.h>)

# sparsha_precompiled_set(name [HEADERS header...] [LIBS lib...] [FLAGS flag...]): for targets that are compiled with those
# flags; headers and libraries are those that such targets need besides.
# Compilers refuse a precompiled header under other macros, another optimisation or another model of addresses.
function(sparsha_precompiled_set name)
  cmake_parse_arguments(ARG "" "" "HEADERS;LIBS;FLAGS" ${ARGN})
  set(source ${CMAKE_BINARY_DIR}/precompiled/${name}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "namespace sparsha {}\n")
  add_library(${name} OBJECT EXCLUDE_FROM_ALL ${source})
  target_link_libraries(${name} PRIVATE sparsha_options Eigen3::Eigen fmt::fmt ${ARG_LIBS})
  target_precompile_headers(${name} PRIVATE ${SPARSHA_PRECOMPILED_HEADERS} ${ARG_HEADERS})
  if(ARG_FLAGS)
    set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
    target_compile_options(${name} PRIVATE ${ARG_FLAGS})
  endif()
  # For ccache, which else reads the 150 MB of a precompiled header for each source.
  if(SPARSHA_CCACHE AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND NOT CMAKE_CONFIGURATION_TYPES)
    set(folder ${CMAKE_BINARY_DIR}/CMakeFiles/${name}.dir)
    set(header ${folder}/cmake_pch.hxx.gch)
    add_custom_command(OUTPUT ${header}.sum COMMAND ${CMAKE_COMMAND} -E sha256sum cmake_pch.hxx.gch > cmake_pch.hxx.gch.sum
      WORKING_DIRECTORY ${folder} DEPENDS ${name} ${header} VERBATIM)  # its name alone, so that any folder has the same sum
    add_custom_target(${name}_sum DEPENDS ${header}.sum)
  endif()
endfunction()

# sparsha_precompiled(target set): the target takes its headers from there.
function(sparsha_precompiled target set)
  if(TARGET ${set})
    target_precompile_headers(${target} REUSE_FROM ${set})
  endif()
  if(TARGET ${set}_sum)
    add_dependencies(${target} ${set}_sum)
  endif()
endfunction()

if(SPARSHA_PRECOMPILE AND NOT MSVC)
  target_compile_definitions(sparsha_options INTERFACE $<TARGET_PROPERTY:fmt::fmt,INTERFACE_COMPILE_DEFINITIONS>)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # As -Wno-restrict (cmake/options.cmake): the alarm on std::string +, which precompiled headers let through.
    target_compile_options(sparsha_options INTERFACE -Wno-stringop-overflow -Wno-stringop-overread
      -Wno-array-bounds)
  endif()
  sparsha_precompiled_set(sparsha_precompiled)
  sparsha_precompiled_set(sparsha_precompiled_program FLAGS -fPIE)
  if(SPARSHA_BUILD_TESTS)
    sparsha_precompiled_set(sparsha_precompiled_tests HEADERS <gmock/gmock.h> <gtest/gtest.h> LIBS GTest::gmock GTest::gtest
      FLAGS -fPIE ${SPARSHA_TEST_FLAGS})
  endif()
endif()
