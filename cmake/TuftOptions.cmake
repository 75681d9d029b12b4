# Compiler settings shared by every target.
option(TUFT_BUILD_TESTS "build the tests" ON)
option(TUFT_BUILD_BENCH "build the benchmark programs" ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)  # tuft finds liggghts_host beside itself
option(TUFT_NATIVE "optimise for the processor of this machine (-march=native)" ON)
set(TUFT_SANITIZE "" CACHE STRING "sanitizers to build with, e.g. address,undefined or thread")

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

# Every target of ours links tuft::options.
add_library(tuft_options INTERFACE)
add_library(tuft::options ALIAS tuft_options)
target_include_directories(tuft_options INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(tuft_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror
  # errno and traps of the maths library are never read; both forbid vectorising sqrt and divisions.
  # Value-changing flags (-ffast-math) are not used: NaN must stay NaN and sums keep their order.
  -fno-math-errno -fno-trapping-math)
if(TUFT_NATIVE)
  target_compile_options(tuft_options INTERFACE -march=native)
  # GCC before 13 takes the undefined lanes inside its own 512-bit intrinsics, which Eigen's products use too, for
  # variables of ours (https://gcc.gnu.org/PR105593). Builds for other processors keep both warnings.
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    include(CheckCXXSourceCompiles)
    set(CMAKE_REQUIRED_FLAGS -march=native)
    check_cxx_source_compiles("#ifndef __AVX512F__\n#error none\n#endif\nint main() {}" TUFT_HAS_AVX512)
    unset(CMAKE_REQUIRED_FLAGS)
    if(TUFT_HAS_AVX512)
      target_compile_options(tuft_options INTERFACE -Wno-uninitialized -Wno-maybe-uninitialized)
    endif()
  endif()
endif()
# For files with inner loops for many combinations of effects. They make units so large that GCC stops inlining what all of
# them are made of, down to a choice between two numbers: a fifth of the speed (docs/performance.md).
set(TUFT_LOOP_OPTIONS "")
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  set(TUFT_LOOP_OPTIONS --param=inline-unit-growth=3000 --param=large-function-growth=3000 --param=max-inline-insns-auto=200)
endif()
if(TUFT_SANITIZE)
  add_compile_options(-fsanitize=${TUFT_SANITIZE} -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${TUFT_SANITIZE})
endif()
find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()

# tuft_library(NAME SOURCES ... [PUBLIC targets...] [PRIVATE targets...])
function(tuft_library name)
  cmake_parse_arguments(A "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(tuft_${name} STATIC ${A_SOURCES})
  add_library(tuft::${name} ALIAS tuft_${name})
  target_link_libraries(tuft_${name} PUBLIC tuft::options ${A_PUBLIC} PRIVATE ${A_PRIVATE})
endfunction()
