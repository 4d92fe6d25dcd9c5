"""What a scene is, the equations, and the machine that picks the model the scene needs."""
