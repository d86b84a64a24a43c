"""Look-ahead: the velocity along a path of many elements, planned over a window of them."""
