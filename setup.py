"""Python modules of the package, installed by catkin (catkin_python_setup); not run by hand."""

from distutils.core import setup

from catkin_pkg.python_setup import generate_distutils_setup

setup(**generate_distutils_setup(packages=["omnitag", "omnitag.foreign_maps", "omnitag.printing",
                                           "omnitag.rendering"],
                                 package_dir={"": "python"}))
