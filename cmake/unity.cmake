# Sources of a target compiled several at once: what they all include, and what they all make of the library's templates, is
# compiled once. `make run` and `make test` ask for it; who changes the program compiles file by file. Which files share a
# group, tools/unity-groups.py says.
option(SPARSHA_UNITY "Compile several sources of a target as one" OFF)
set(SPARSHA_UNITY_LINES 1500)  # of a group: some 5 to 20 s of a compiler, so that no core waits long for the last one

if(SPARSHA_UNITY)
  find_package(Python3 COMPONENTS Interpreter QUIET)
  if(NOT Python3_Interpreter_FOUND)
    message(STATUS "SPARSHA_UNITY: no Python is found; sources are compiled one by one")
  else()
    # What is found may be a script that looks for the interpreter each time, which takes longer than the tool.
    execute_process(COMMAND ${Python3_EXECUTABLE} -c "import sys; print(sys.executable, end='')"
      OUTPUT_VARIABLE SPARSHA_UNITY_PYTHON COMMAND_ERROR_IS_FATAL ANY)
  endif()
endif()

# GCC collects its garbage less often where each of its processes may have 2 GB: a twentieth of the time.
if(SPARSHA_UNITY AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  cmake_host_system_information(RESULT megabytes QUERY TOTAL_PHYSICAL_MEMORY)
  cmake_host_system_information(RESULT cores QUERY NUMBER_OF_LOGICAL_CORES)
  math(EXPR megabytes_of_core "${megabytes} / ${cores}")
  if(megabytes_of_core GREATER 2000)
    target_compile_options(sparsha_options INTERFACE "SHELL:--param ggc-min-heapsize=1000000" "SHELL:--param ggc-min-expand=200")
  endif()
endif()

# sparsha_unity(target source...): absolute paths, or relative to the present folder.
function(sparsha_unity target)
  if(NOT SPARSHA_UNITY OR NOT Python3_Interpreter_FOUND)
    return()
  endif()
  execute_process(COMMAND ${SPARSHA_UNITY_PYTHON} ${PROJECT_SOURCE_DIR}/tools/unity-groups.py ${SPARSHA_UNITY_LINES} ${ARGN}
    WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} OUTPUT_VARIABLE pairs COMMAND_ERROR_IS_FATAL ANY)
  foreach(pair ${pairs})
    string(REPLACE "|" ";" pair ${pair})
    list(GET pair 0 source)
    list(GET pair 1 number)
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${target}_${number})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC takes the sources of a group for headers, which must not have members of a type of an unnamed namespace.
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
  endif()
endfunction()
