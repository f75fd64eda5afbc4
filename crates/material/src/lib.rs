//! Constitutive models of large-strain solid mechanics as pure functions of one point's kinematics and history.
