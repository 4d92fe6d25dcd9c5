"""What is said of one scene, in words and equations."""
