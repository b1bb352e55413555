# The package: find_package(pointsweep) gives an outside project pointsweep::pointsweep and, with the static library,
# pointsweep::info, verify, shapes, render and report.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/pointsweep)

install(TARGETS pointsweep pointsweep_shared pointsweep_info pointsweep_verify pointsweep_shapes pointsweep_render pointsweep_report
  EXPORT pointsweep-targets)
install(DIRECTORY include/pointsweep DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
if(POINTSWEEP_HAS_CODECS)
  install(FILES $<TARGET_FILE:pointsweep_codecs> DESTINATION ${CMAKE_INSTALL_LIBDIR})
endif()
install(EXPORT pointsweep-targets NAMESPACE pointsweep:: DESTINATION ${package_folder})

configure_package_config_file(cmake/pointsweep-config.cmake.in ${PROJECT_BINARY_DIR}/pointsweep-config.cmake
  INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/pointsweep-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/pointsweep-config.cmake ${PROJECT_BINARY_DIR}/pointsweep-config-version.cmake
  DESTINATION ${package_folder})

if(TARGET pointsweep_cli)
  install(TARGETS pointsweep_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  if(NOT CMAKE_CROSSCOMPILING)
    install(FILES ${PROJECT_BINARY_DIR}/completions/pointsweep DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
    install(FILES ${PROJECT_BINARY_DIR}/completions/_pointsweep DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
    install(FILES ${PROJECT_BINARY_DIR}/completions/pointsweep.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
    install(DIRECTORY ${PROJECT_BINARY_DIR}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 FILES_MATCHING PATTERN "*.1")
  endif()
endif()
