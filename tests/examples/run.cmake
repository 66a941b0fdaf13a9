# Installs both components into empty folders, builds the examples against them and runs them, and compiles all headers
# of the core. cmake -DBUILD=... -DSOURCE=... -DWORK=... -DCOMPILER=... -DFLAGS=... -P run.cmake
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${ARGV}\nended with ${code}:\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --component haptics --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} --install ${BUILD} --component pcl --prefix ${WORK}/both)
run(${CMAKE_COMMAND} --install ${BUILD} --component haptics --prefix ${WORK}/both)

# Nothing but Eigen and the standard library behind the headers.
file(GLOB public RELATIVE ${WORK}/prefix/include ${WORK}/prefix/include/sparsha/*.h)
foreach(name version error scene surface proxy renderer device device_plugin servo)
  list(APPEND expected sparsha/${name}.h)
endforeach()
list(SORT expected)
if(NOT public STREQUAL expected)
  message(FATAL_ERROR "the public headers are ${public}; expected ${expected}")
endif()
file(GLOB_RECURSE headers RELATIVE ${WORK}/prefix/include ${WORK}/prefix/include/*.h)
list(LENGTH headers count)
if(count LESS 20)
  message(FATAL_ERROR "only ${count} headers are installed")
endif()
foreach(header ${headers})
  file(STRINGS ${WORK}/prefix/include/${header} lines REGEX "^ *# *include *<")
  foreach(line ${lines})
    if(line MATCHES "<(yaml|tiff|openssl|fmt|spdlog|pcl|opencv|libusb|nlohmann)")
      message(FATAL_ERROR "${header}: ${line}")
    endif()
  endforeach()
  # Those below `detail` by the names that they had in versions before.
  string(REPLACE "sparsha/detail/" "" header ${header})
  list(APPEND includes "#include \"${header}\"")
endforeach()

run(${CMAKE_COMMAND} -S ${SOURCE}/examples -B ${WORK}/examples -DCMAKE_PREFIX_PATH=${WORK}/both
  -DCMAKE_CXX_COMPILER=${COMPILER} "-DCMAKE_CXX_FLAGS=${FLAGS}")
run(${CMAKE_COMMAND} --build ${WORK}/examples)
file(GLOB sources ${SOURCE}/examples/*.cpp)
foreach(source ${sources})
  cmake_path(GET source STEM example)
  file(READ ${source} text)
  string(REGEX MATCHALL "\n" lines "${text}")  # file(STRINGS) would join lines between brackets
  list(LENGTH lines count)
  if(NOT count LESS 60)
    message(FATAL_ERROR "${example} has ${count} lines; expected fewer than 60")
  endif()
  run(${WORK}/examples/${example})
  message(STATUS "${example}: ${output}")
endforeach()

# Beside the program, and without PCL's component, those examples remain that need none.
run(${CMAKE_COMMAND} --install ${BUILD} --component program --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE}/examples -B ${WORK}/fewer -DCMAKE_PREFIX_PATH=${WORK}/prefix
  -DCMAKE_CXX_COMPILER=${COMPILER} "-DCMAKE_CXX_FLAGS=${FLAGS}")
run(${CMAKE_COMMAND} --build ${WORK}/fewer --target help)
if(NOT output MATCHES "04_a_device_of_your_own" OR output MATCHES "05_from_a_pcl_cloud")
  message(FATAL_ERROR "without PCL's component the examples are:\n${output}")
endif()

# The haptics component alone, all headers at once, as a user's prefix header might.
list(JOIN includes "\n" includes)
file(WRITE ${WORK}/headers/all.cpp "${includes}\n")
foreach(header ${public})
  cmake_path(GET header STEM name)
  file(WRITE ${WORK}/headers/${name}.cpp "#include <${header}>\n")  # alone
  list(APPEND alone ${name}.cpp)
endforeach()
list(JOIN alone " " alone)
file(WRITE ${WORK}/headers/CMakeLists.txt "cmake_minimum_required(VERSION 3.20)\nproject(headers LANGUAGES CXX)\n"
  "set(CMAKE_CXX_STANDARD 20)\nfind_package(Sparsha REQUIRED COMPONENTS haptics)\nadd_library(headers OBJECT all.cpp ${alone})\n"
  "target_link_libraries(headers PRIVATE sparsha::haptics)\n")
run(${CMAKE_COMMAND} -S ${WORK}/headers -B ${WORK}/headers/build -DCMAKE_PREFIX_PATH=${WORK}/prefix
  -DCMAKE_CXX_COMPILER=${COMPILER} "-DCMAKE_CXX_FLAGS=${FLAGS}")
run(${CMAKE_COMMAND} --build ${WORK}/headers/build)

# The same by add_subdirectory: other packages are not looked for, and the install says what is to be built first. Without
# debug information and with several sources as one, which compile in a third of the time.
file(WRITE ${WORK}/guest/CMakeLists.txt "cmake_minimum_required(VERSION 3.20)\nproject(guest LANGUAGES CXX)\n"
  "add_subdirectory(${SOURCE} sparsha)\nadd_subdirectory(${SOURCE}/examples examples)\n")
find_program(CCACHE ccache)
if(CCACHE)
  set(launcher -DCMAKE_CXX_COMPILER_LAUNCHER=${CCACHE})
endif()
run(${CMAKE_COMMAND} -S ${WORK}/guest -B ${WORK}/guest/build -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-g0 -DSPARSHA_UNITY=ON
  -DCMAKE_CXX_COMPILER=${COMPILER} "-DCMAKE_CXX_FLAGS=${FLAGS}" ${launcher})
file(STRINGS ${WORK}/guest/build/CMakeCache.txt looked_for REGEX "PCL|OpenCV|yaml-cpp|TIFF|GLFW|glfw|LIBUSB|SPARSHA_BUILD_TESTS:BOOL=ON")
if(looked_for)
  message(FATAL_ERROR "a guest of the renderer alone looked for ${looked_for}")
endif()
execute_process(COMMAND ${CMAKE_COMMAND} --install ${WORK}/guest/build --component haptics --prefix ${WORK}/guest/prefix
  RESULT_VARIABLE code ERROR_VARIABLE output)
string(REGEX REPLACE "[ \n]+" " " output "${output}")
if(code EQUAL 0 OR NOT output MATCHES "is not built; first: cmake --build")
  message(FATAL_ERROR "installing what is not built ended with ${code}:\n${output}")
endif()
run(${CMAKE_COMMAND} --build ${WORK}/guest/build -j 2 --target 01_touch_a_height_field)
run(${WORK}/guest/build/examples/01_touch_a_height_field)

# A program built with PCL's component starts without VTK.
execute_process(COMMAND ldd ${WORK}/examples/05_from_a_pcl_cloud OUTPUT_VARIABLE libraries)
if(libraries MATCHES "vtk")
  message(FATAL_ERROR "VTK is linked:\n${libraries}")
endif()

# A component that there is not is named, and nothing is found.
file(WRITE ${WORK}/wrong/CMakeLists.txt "cmake_minimum_required(VERSION 3.20)\nproject(wrong LANGUAGES CXX)\n"
  "find_package(Sparsha COMPONENTS haptics viewer QUIET)\nif(Sparsha_FOUND)\n  message(FATAL_ERROR found)\nendif()\n")
run(${CMAKE_COMMAND} -S ${WORK}/wrong -B ${WORK}/wrong/build -DCMAKE_PREFIX_PATH=${WORK}/prefix
  -DCMAKE_CXX_COMPILER=${COMPILER})
file(REMOVE_RECURSE ${WORK})
