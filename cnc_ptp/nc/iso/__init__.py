"""The vocabulary `iso`: what CAM post-processors write for Fanuc and LinuxCNC."""
