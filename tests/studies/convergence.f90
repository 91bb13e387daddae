program study_convergence
  !! Errors of the thick cylinder over basis, degree and mesh, as comma-separated lines; read by convergence.py.
  use, intrinsic :: iso_fortran_env, only: output_unit
  use cylinder_errors, only: cylinder_result, solve_cylinder
  implicit none (type, external)
  integer, parameter :: largest = 5          ! degrees
  character(1), parameter :: bases(2) = ['N', 'L']
  ! finest meshes: at most one has an L2 error at rounding; smooth functions reach their rate on finer ones
  integer, parameter :: finest(largest, 2) = reshape([64, 64, 64, 64, 64, 64, 64, 32, 16, 16], [largest, 2])
  integer, parameter :: meshes = 5
  type(cylinder_result) :: found, again
  integer :: b, p, k, mesh, repeat

  write (output_unit, '(a)') 'basis,p,mesh,dofs,energy,l2,seconds'
  do b = 1, size(bases)
    do p = merge(2, 1, bases(b) == 'N'), largest
      do k = meshes - 1, 0, -1
        mesh = finest(p, b)/2**k
        if (mesh == 0) cycle
        call solve_cylinder(bases(b), p, mesh, found)
        do repeat = 1, 2          ! the shortest of three
          call solve_cylinder(bases(b), p, mesh, again)
          found%seconds = min(found%seconds, again%seconds)
        end do
        if (.not. found%solved) error stop 'the deck was not solved'
        write (output_unit, '(a,3(",",i0),3(",",es12.5))') bases(b), p, mesh, found%dofs, found%energy, found%l2, &
          found%seconds
        flush (output_unit)
      end do
    end do
  end do
end program study_convergence
