# What the libraries share: version, include path, and the rule that each exports what its header declares.

# Names of the functions that a public header declares.
function(kdray_declared out header)
  set(path ${PROJECT_SOURCE_DIR}/include/kdray/${header})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${path})
  file(STRINGS ${path} lines REGEX "^KDR_API ")
  set(names)
  foreach(line IN LISTS lines)
    if(line MATCHES "(kdr_[a-z0-9_]+)\\(")
      list(APPEND names ${CMAKE_MATCH_1})
    endif()
  endforeach()
  set(${out} ${names} PARENT_SCOPE)
endfunction()

# kdray_library(NAME HEADER): libkdray and libkdray-render both hold the base, so each has its own list of exports.
function(kdray_library name header)
  target_include_directories(${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  string(REPLACE "kdray-" "" export_name ${name})
  set_target_properties(${name} PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}
    LINKER_LANGUAGE C EXPORT_NAME ${export_name} INSTALL_RPATH "$ORIGIN")
  add_library(kdray::${name} ALIAS ${name})
  if(NOT export_name STREQUAL name)
    add_library(kdray::${export_name} ALIAS ${name})
  endif()

  if(BUILD_SHARED_LIBS)
    kdray_declared(names ${header})
    list(JOIN names ";\n    " names)
    set(map ${PROJECT_BINARY_DIR}/${name}.map)
    configure_file(${PROJECT_SOURCE_DIR}/cmake/exports.map.in ${map} @ONLY)
    target_link_options(${name} PRIVATE "LINKER:--version-script=${map}" LINKER:--no-undefined)
    set_property(TARGET ${name} APPEND PROPERTY LINK_DEPENDS ${map})
  endif()
endfunction()
