module half_edges
  !! Which edges of polygons are the same: every edge once from each of the one or two faces that it
  !! belongs to, in opposite directions.
  use extraction_mesh, only: whole_number
  implicit none (type, external)
  private
  public :: pair_half_edges

contains

  pure subroutine pair_half_edges(nv, vertex, next, face, twin, message)
    integer, intent(in) :: nv                            !! vertices
    integer, intent(in) :: vertex(:)                     !! that each half-edge starts from (nh)
    integer, intent(in) :: next(:)                       !! half-edge of the same face (nh)
    integer, intent(in) :: face(:)                       !! of each half-edge (nh)
    integer, intent(out) :: twin(:)                      !! the same edge of the other face, 0: none
    character(:), allocatable, intent(inout) :: message  !! what is no manifold; else unchanged

    integer, allocatable :: behind(:), head(:)
    integer :: a, b, h, other, same, turned

    ! half-edges by the smaller vertex
    allocate (head(nv), behind(size(vertex)), source=0)
    do h = 1, size(vertex)
      a = min(vertex(h), vertex(next(h)))
      behind(h) = head(a)
      head(a) = h
    end do
    twin = 0
    do h = 1, size(vertex)
      a = vertex(h)
      b = vertex(next(h))
      same = 0
      turned = 0
      other = head(min(a, b))
      do while (other > 0)
        if (other /= h .and. vertex(other) == a .and. vertex(next(other)) == b) same = other
        if (vertex(other) == b .and. vertex(next(other)) == a) then
          if (turned > 0) same = turned
          turned = other
        end if
        other = behind(other)
      end do
      if (same > 0 .and. turned > 0) then
        message = 'more than two faces meet at the edge of vertices ' // whole_number(a) // &
          ' and ' // whole_number(b) // ', faces ' // whole_number(face(h)) // ' and ' // &
          whole_number(face(same)) // ' among them: the surface is not a manifold'
        return
      else if (same > 0) then
        message = 'faces ' // whole_number(face(min(h, same))) // ' and ' // &
          whole_number(face(max(h, same))) // ' run along the edge of vertices ' // &
          whole_number(a) // ' and ' // whole_number(b) // &
          ' in the same direction: turn one of them round'
        return
      end if
      twin(h) = turned
    end do
  end subroutine pair_half_edges
end module half_edges
