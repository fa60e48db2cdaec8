# What is built, with which flags, against which libraries.

set(CMAKE_C_STANDARD 17)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_C_EXTENSIONS ON) # vector extensions and POSIX names
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_C_VISIBILITY_PRESET hidden)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Debug, Release, RelWithDebInfo" FORCE)
endif()
set(CMAKE_C_FLAGS_RELEASE "-O3 -DNDEBUG")

option(BUILD_SHARED_LIBS "Build shared libraries" ON)
option(KDRAY_RENDER "Build libkdray-render: files to pictures" ON)
option(KDRAY_PROGRAM "Build the program kdray" ${PROJECT_IS_TOP_LEVEL})
option(KDRAY_TESTS "Build the tests" ${PROJECT_IS_TOP_LEVEL})
option(KDRAY_EXPERIMENTS "Build the experiments of bench/ (the tests do so too)" OFF)
option(KDRAY_FUZZ "Build the fuzz targets (clang only)" OFF)
option(KDRAY_OPENMP "Build libkdray-openmp, the OpenMP task backend" ON)
option(KDRAY_ASSIMP "Read glTF and other formats through assimp" ON)
option(KDRAY_WINDOW "Let kdray view open windows, by SDL2" ON)
option(KDRAY_COUNTING "Count what queries do, for kdray info --trace; slower" OFF)
option(KDRAY_WERROR "Treat warnings as errors" OFF)
set(KDRAY_SANITIZE "" CACHE STRING "Sanitizers, as in -fsanitize=")

if(KDRAY_FUZZ OR NOT KDRAY_RENDER)
  set(KDRAY_PROGRAM OFF)
endif()

set(THREADS_PREFER_PTHREAD_FLAG ON)
find_package(Threads REQUIRED)

# Flags and include paths of every source of the project.
add_library(kdray_settings INTERFACE)
target_include_directories(kdray_settings INTERFACE
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
target_compile_definitions(kdray_settings INTERFACE _GNU_SOURCE)
target_compile_options(kdray_settings INTERFACE
  -ffp-contract=off -fno-math-errno -Wall -Wextra -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wpointer-arith
  -Wvla -Wno-psabi $<$<BOOL:${KDRAY_WERROR}>:-Werror>)
if(KDRAY_COUNTING)
  target_compile_definitions(kdray_settings INTERFACE KDR_COUNTING)
endif()
if(KDRAY_SANITIZE)
  target_compile_options(kdray_settings INTERFACE
    -fsanitize=${KDRAY_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(kdray_settings INTERFACE -fsanitize=${KDRAY_SANITIZE})
  add_link_options(-fsanitize=${KDRAY_SANITIZE})
endif()

if(KDRAY_FUZZ)
  target_compile_options(kdray_settings INTERFACE -fsanitize=fuzzer-no-link)
endif()

if(KDRAY_OPENMP)
  find_package(OpenMP COMPONENTS C)
  if(NOT OpenMP_C_FOUND)
    message(STATUS "kdray: no OpenMP, libkdray-openmp is left out")
    set(KDRAY_OPENMP OFF)
  endif()
endif()

# Libraries behind libkdray-render.
if(KDRAY_RENDER)
  find_package(PNG REQUIRED)
  find_package(ZLIB REQUIRED)
  set(KDRAY_FORMAT_LIBRARIES PNG::PNG ZLIB::ZLIB)
  if(KDRAY_ASSIMP)
    find_package(PkgConfig REQUIRED)
    pkg_check_modules(assimp IMPORTED_TARGET assimp)
    if(assimp_FOUND)
      list(APPEND KDRAY_FORMAT_LIBRARIES PkgConfig::assimp)
      target_compile_definitions(kdray_settings INTERFACE KDR_WITH_ASSIMP)
    else()
      message(STATUS "kdray: no assimp, only PLY, OBJ and STL are read")
    endif()
  endif()
endif()
