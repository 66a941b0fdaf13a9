# Compiler settings shared by every target. No -march=native and no AVX here: Debian's PCL and Eigen are built
# for baseline x86-64, and mixing alignments breaks their ABI. Vector kernels set their own flags per file.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
if(SPARSHA_IS_TOP_LEVEL)
  set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
endif()

find_program(SPARSHA_CCACHE ccache)
if(SPARSHA_IS_TOP_LEVEL AND SPARSHA_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${SPARSHA_CCACHE})
  if(SPARSHA_PRECOMPILE)
    # What ccache asks for to take precompiled headers: no macro of time stands in them. It compares them by a checksum beside
    # them (cmake/precompiled.cmake), and takes what a source includes from the compiler instead of preprocessing it first.
    set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_PCH_EXTSUM=true
      CCACHE_DEPEND=true ${SPARSHA_CCACHE})
  endif()
endif()

# Others include what is in include/sparsha; what these headers include keeps its path from the root, below `detail`.
# That folder is searched, too: includes of versions before 0.1, such as "haptics/proxy/proxy.h", work until 0.2.
include(GNUInstallDirs)
set(SPARSHA_INSTALL_INCLUDE ${CMAKE_INSTALL_INCLUDEDIR}/sparsha/detail)
if(NOT SPARSHA_IS_TOP_LEVEL)
  set(SPARSHA_GUESTS_INCLUDE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/earlier>)
endif()

add_library(sparsha_options INTERFACE)
target_include_directories(sparsha_options INTERFACE ${PROJECT_SOURCE_DIR})
if(MSVC)
  target_compile_options(sparsha_options INTERFACE /W4 $<$<BOOL:${SPARSHA_WARNINGS_AS_ERRORS}>:/WX> /utf-8)
else()
  target_compile_options(sparsha_options INTERFACE
    -Wall -Wextra -Wpedantic -Wconversion -Wshadow $<$<BOOL:${SPARSHA_WARNINGS_AS_ERRORS}>:-Werror> -ffp-contract=off)
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    target_compile_options(sparsha_options INTERFACE -Wno-sign-conversion)  # GCC's -Wconversion leaves signs out, too
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(sparsha_options INTERFACE -Wno-restrict)  # false alarms on std::string + in GCC 12 (PR 105651)
  endif()
endif()
# The same bytes whatever the folder: debug information names files from the root of the tree. A release names none.
if(NOT MSVC)
  target_compile_options(sparsha_options INTERFACE
    $<$<CONFIG:Debug,RelWithDebInfo>:-ffile-prefix-map=${PROJECT_SOURCE_DIR}=. -ffile-prefix-map=${PROJECT_BINARY_DIR}=build>)
endif()
if(SPARSHA_SANITIZE)
  target_compile_options(sparsha_options INTERFACE
    -fsanitize=${SPARSHA_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  # Eigen allocates in another way under AddressSanitizer; memory that PCL's library frees must come from malloc.
  target_compile_definitions(sparsha_options INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
  target_link_options(sparsha_options INTERFACE -fsanitize=${SPARSHA_SANITIZE})
endif()
if(SPARSHA_LIBRARY_ASSERTIONS OR SPARSHA_SANITIZE)
  # Indices of vectors, spans and the like that are beyond the end but still within the memory, which no sanitizer sees;
  # changes no layout.
  target_compile_definitions(sparsha_options INTERFACE _GLIBCXX_ASSERTIONS=1)
endif()
# What makes a fault in a reader of strangers' files an end of the program and not a way in: checked copies, guarded
# stacks, marked branch targets, tables that are read-only once the program is loaded. The price is in docs/change/portability.md.
option(SPARSHA_HARDEN "Stack protector, checked library calls, control-flow marks, full RELRO" ON)
include(CheckPIESupported)
check_pie_supported(LANGUAGES CXX)
if(SPARSHA_HARDEN AND NOT MSVC)
  target_compile_options(sparsha_options INTERFACE -fstack-protector-strong)
  if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
    target_link_options(sparsha_options INTERFACE -Wl,-z,relro,-z,now)
    if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
      target_compile_options(sparsha_options INTERFACE -fcf-protection=full -fstack-clash-protection)
    endif()
    if(NOT SPARSHA_SANITIZE)  # sanitizers check these calls themselves; without optimisation the checks do nothing but warn
      target_compile_options(sparsha_options INTERFACE
        $<$<NOT:$<CONFIG:Debug>>:-U_FORTIFY_SOURCE> $<$<NOT:$<CONFIG:Debug>>:-D_FORTIFY_SOURCE=2>)
    endif()
  endif()
endif()
find_package(Threads REQUIRED)
target_link_libraries(sparsha_options INTERFACE Threads::Threads)

# sparsha_library(name SOURCES ... [PUBLIC libs...] [PRIVATE libs...]): one static library of a room.
function(sparsha_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC ${ARG_PUBLIC} PRIVATE $<BUILD_INTERFACE:sparsha_options> ${ARG_PRIVATE})
  target_include_directories(${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> ${SPARSHA_GUESTS_INCLUDE}
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}> $<INSTALL_INTERFACE:${SPARSHA_INSTALL_INCLUDE}>)
  target_compile_features(${name} PUBLIC cxx_std_20)
  if(COMMAND sparsha_precompiled)
    sparsha_precompiled(${name} sparsha_precompiled)
  endif()
  sparsha_unity(${name} ${ARG_SOURCES})
endfunction()

# What is tested keeps -O3; tests compile a quarter faster so.
if(NOT MSVC)
  set(SPARSHA_TEST_FLAGS $<$<CONFIG:Release>:-O1>)
endif()

# Test programs are linked by a faster linker where there is one; what is installed, by the default.
include(CheckLinkerFlag)
if(SPARSHA_BUILD_TESTS AND NOT MSVC AND NOT SPARSHA_SANITIZE)
  check_linker_flag(CXX -fuse-ld=gold SPARSHA_HAS_GOLD)
  if(SPARSHA_HAS_GOLD)
    set(SPARSHA_TEST_LINKER -fuse-ld=gold)
  endif()
endif()

# sparsha_support(name SOURCES ... LIBS ...): a library of what several test programs share, compiled once and as they are.
function(sparsha_support name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBS" ${ARGN})
  add_library(${name} STATIC EXCLUDE_FROM_ALL ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE sparsha_options PUBLIC ${ARG_LIBS})
  target_compile_options(${name} PRIVATE ${SPARSHA_TEST_FLAGS})
  if(COMMAND sparsha_precompiled)
    sparsha_precompiled(${name} sparsha_precompiled)
  endif()
  sparsha_unity(${name} ${ARG_SOURCES})
endfunction()

# sparsha_test(name SOURCES ... LIBS ...): a GoogleTest program whose cases CTest sees one by one.
function(sparsha_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBS;PROPERTIES" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE sparsha_options ${ARG_LIBS} GTest::gmock GTest::gtest_main)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  target_compile_options(${name} PRIVATE ${SPARSHA_TEST_FLAGS})
  target_link_options(${name} PRIVATE ${SPARSHA_TEST_LINKER})
  if(COMMAND sparsha_precompiled)
    sparsha_precompiled(${name} sparsha_precompiled_tests)
  endif()
  sparsha_unity(${name} ${ARG_SOURCES})
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST PROPERTIES TIMEOUT 600 ${ARG_PROPERTIES})
endfunction()

# sparsha_folder_library(name folder... [EXCEPT file...] [PUBLIC ...] [PRIVATE ...]): one static library of the .cpp
# files of some folders.
function(sparsha_folder_library name)
  cmake_parse_arguments(ARG "" "" "EXCEPT;PUBLIC;PRIVATE" ${ARGN})
  set(sources)
  foreach(folder ${ARG_UNPARSED_ARGUMENTS})
    file(GLOB found CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.cpp)
    list(APPEND sources ${found})
  endforeach()
  list(TRANSFORM ARG_EXCEPT PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  foreach(source ${sources})
    cmake_path(NORMAL_PATH source)
    list(APPEND normal ${source})
  endforeach()
  list(REMOVE_ITEM normal ${ARG_EXCEPT})
  sparsha_library(${name} SOURCES ${normal} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
endfunction()

# sparsha_folder_test(folder... libs...): the *_test.cpp (and helpers) of some folders as one test program, named after
# the first of them.
function(sparsha_folder_test folder)
  string(REPLACE "/" "_" name ${folder})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.cpp)
  set(libraries ${ARGN})
  foreach(argument ${ARGN})
    if(IS_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/${argument})
      file(GLOB found CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${argument}/*.cpp)
      list(APPEND sources ${found})
      list(REMOVE_ITEM libraries ${argument})
    endif()
  endforeach()
  sparsha_test(${name}_test SOURCES ${sources} LIBS ${libraries})
endfunction()
