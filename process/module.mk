# Import, registration, geometry, model; PCL behind C headers.
programs += process/pleinair-jobsd process/pleinair-copy process/pleinair-import process/pleinair-process process/pleinair-segments process/pleinair-align process/pleinair-report process/pleinair-pictures process/pleinair-export process/pleinair-calibrate
packages += g++ libpcl-dev libeigen3-dev libopencv-core-dev libopencv-dnn-dev libopencv-imgproc-dev libopencv-calib3d-dev libxml2-dev libassimp-dev
pkgs += libxml-2.0 assimp
cxx_pkgs += eigen3 pcl_common pcl_io pcl_features pcl_filters pcl_registration pcl_search pcl_kdtree pcl_sample_consensus
cxx_libs += -lpcl_io_ply -lopencv_dnn -lopencv_calib3d -lopencv_imgproc -lopencv_core
# Named here, for opencv4's own flags link all that it has.
cxx_flags += -isystem /usr/include/opencv4
# Vectors as arguments of functions that are all inlined.
$(BUILD)/process/normals-%.o: house_cflags += -Wno-psabi
buses += process/jobs:org.pleinair.Jobs1
