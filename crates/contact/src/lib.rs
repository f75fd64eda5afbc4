//! Rigid obstacles for particle methods: signed distance, contact laws, reaction forces.
