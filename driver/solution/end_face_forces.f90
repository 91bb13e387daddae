module end_face_forces
  !! The condition of end faces that are free to warp, lambda Phi(u, theta) with Phi = sum_a (r_a + u_a) . R(theta) lever_a
  !! (see module end_face), as a sum over their points: forces and tangent of one point and the face's globals are
  !!
  !!     f_a = lambda R lever_a         k_a,theta = lambda R' lever_a      k_a,lambda = R lever_a
  !!     f_theta = lambda x . R' lever_a    k_theta,theta = lambda x . R'' lever_a    k_theta,lambda = x . R' lever_a
  !!     f_lambda = x . R lever_a
  use kinds, only: wp
  use end_face, only: end_face_geometry, turn
  use bulk_elements, only: add_moved_force
  use equation_system, only: equation_system_type
  implicit none (type, external)
  private
  public :: assemble_end_faces

  integer, parameter :: angle = 1, multiplier = 2   !! components of a face's column

contains

  subroutine assemble_end_faces(system, u, du, moves, want_tangent, f, f_moved)
    !! Add to nodal forces, and to the matrix and the forces' first-order change by du.
    type(equation_system_type), intent(inout) :: system
    real(wp), intent(in) :: u(:, :), du(:, :)     !! control values (ndf,nn)
    logical, intent(in) :: moves(:)               !! (nn) du is not zero there; size 0: nowhere
    logical, intent(in) :: want_tangent
    real(wp), intent(inout) :: f(:, :), f_moved(:, :)
    type(end_face_geometry), allocatable :: faces(:)
    real(wp) :: ke(size(u, 1), 2, size(u, 1), 2)
    integer :: k, a, pair(2)

    faces = system%map%faces
    do k = 1, size(faces)
      associate (face => faces(k))
        if (face%rigid) cycle
        do a = 1, size(face%nodes)
          pair = [face%nodes(a), face%rotation]
          call point_condition(face, a, u(:, pair), f(:, pair(1)), f(:, pair(2)), ke)
          if (.not. want_tangent) cycle
          if (size(moves) > 0) then
            if (any(moves(pair))) call add_moved_force(ke, du, pair, .true., f_moved)
          end if
          call system%add_loose(pair, ke, .true.)
        end do
      end associate
    end do
  end subroutine assemble_end_faces

  pure subroutine point_condition(face, a, u, f_point, f_face, ke)
    !! Forces added, tangent of one point and the globals: blocks a >= b.
    type(end_face_geometry), intent(in) :: face
    integer, intent(in) :: a                       !! point of the face
    real(wp), intent(in) :: u(:, :)                !! of the point, of the globals (ndf,2)
    real(wp), intent(inout) :: f_point(:), f_face(:)
    real(wp), intent(out) :: ke(:, :, :, :)        !! (ndf,2,ndf,2)
    real(wp), dimension(size(face%arm, 1)) :: x, r, r1, r2
    integer :: n

    n = size(x)
    x = face%arm(:, a) + u(1:n, 1)
    call turn(face%axis, u(angle, 2), face%lever(:, a), r, r1, r2)
    r = r + face%lever(:, a)
    associate (lambda => u(multiplier, 2))
      f_point(1:n) = f_point(1:n) + lambda*r
      f_face(angle) = f_face(angle) + lambda*dot_product(x, r1)
      f_face(multiplier) = f_face(multiplier) + dot_product(x, r)
      ke = 0
      ke(angle, 2, 1:n, 1) = lambda*r1
      ke(multiplier, 2, 1:n, 1) = r
      ke(angle, 2, angle, 2) = lambda*dot_product(x, r2)
      ke(angle, 2, multiplier, 2) = dot_product(x, r1)
      ke(multiplier, 2, angle, 2) = ke(angle, 2, multiplier, 2)
    end associate
  end subroutine point_condition
end module end_face_forces
